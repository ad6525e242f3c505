#include "operations/manifest/dialogue.hpp"

#include <algorithm>
#include <filesystem>
#include <span>
#include <string_view>

#include "interaction/phrases/core/phrase_file.hpp"
#include "interaction/speech/core/conversation.hpp"
#include "interaction/tablet/core/tablet.hpp"
#include "runtime/parameters/interpret.hpp"
#include "tasks/guide/core/texts.hpp"
#include "tasks/meeting/core/texts.hpp"

namespace usher::operations {

namespace {

/// Who uses a section of the texts: the component type of that name.
struct Section {
  std::string_view name;
  std::span<const std::string_view> keys;
  bool leads;  ///< the dialogue is in the languages of this one
};
constexpr Section kSections[] = {{"guide", guide::kTextKeys, true},
                                 {"meeting", meeting::kTextKeys, true},
                                 {"tablet", tablet::kTextKeys, false},
                                 {"speech", speech::kTextKeys, false}};

struct Setting {
  std::string text;
  std::string origin;  ///< empty = the contract's default
};

Setting setting(const runtime::Contract& contract, const runtime::ParameterFile& file,
                const std::string& name) {
  for (const auto& parameter : contract.parameters) {
    if (parameter.name != name) continue;
    runtime::ParameterValue value{name, parameter.fallback, ""};
    for (const auto& given : file.values) {
      if (given.name == name) value = given;
    }
    if (const auto read = runtime::interpret(parameter, value)) return {read->text, value.origin};
  }
  return {};
}

struct Speaker {
  const ManifestComponent* component;
  bool leads;
  std::vector<std::string> tags;
  std::string origin;  ///< of the list of languages; empty = the contract's default

  const std::string& asked_at() const { return origin.empty() ? component->origin : origin; }
};

/// Once: several components read the same texts.
void add(std::vector<Finding>& findings, Finding finding) {
  const bool known = std::any_of(findings.begin(), findings.end(), [&](const Finding& other) {
    return other.origin == finding.origin && other.text == finding.text;
  });
  if (!known) findings.push_back(std::move(finding));
}

/// Reports the languages without a file in the folder of texts, of which nothing else is said then.
/// Whether there were any.
bool drop_unknown(Speaker& speaker, const std::filesystem::path& folder,
                  std::vector<Finding>& findings) {
  const auto dropped = std::erase_if(speaker.tags, [&](const std::string& tag) {
    const auto file = folder / (tag + ".yaml");
    std::error_code ignored;
    if (std::filesystem::exists(file, ignored)) return false;
    add(findings, {Verdict::kWrongValue,
                   "'" + speaker.component->name + "' speaks the unknown language '" + brief(tag) +
                       "': there is no " + file.string() + suggestion_beside(folder / tag),
                   speaker.asked_at()});
    return true;
  });
  return dropped > 0;
}

}  // namespace

void judge_dialogue(const Contracts& contracts, Deployment& deployment) {
  std::vector<Speaker> speakers;
  const auto& components = deployment.manifest.components;
  for (std::size_t i = 0; i < components.size(); ++i) {
    const auto section =
        std::find_if(std::begin(kSections), std::end(kSections),
                     [&](const Section& s) { return s.name == components[i].type; });
    const auto contract = contracts.find(components[i].type);
    if (section == std::end(kSections) || contract == contracts.end()) continue;
    const auto texts = setting(contract->second, deployment.files[i], "texts");
    const auto languages = setting(contract->second, deployment.files[i], "languages");
    const std::filesystem::path file = texts.text;
    std::error_code ignored;
    if (!file.empty() && !std::filesystem::is_regular_file(file, ignored))
      continue;  // found before
    Speaker speaker{&components[i], section->leads, phrases::tags_of(languages.text),
                    languages.origin};
    if (file.empty()) {
      speaker.tags = {"en"};  // the keys themselves
    } else {
      if (section->name == "meeting") speaker.tags = {file.stem().string()};
      if (drop_unknown(speaker, file.parent_path(), deployment.findings) && speaker.tags.empty())
        continue;
      for (const auto& misprint : phrases::PhraseBook::misprints(
               file.parent_path(), speaker.tags, std::string(section->name), section->keys)) {
        // What is wrong with the folder is wrong with the list of languages.
        add(deployment.findings,
            {Verdict::kWrongValue, misprint.text,
             misprint.origin == file.parent_path() ? speaker.asked_at() : misprint.origin});
      }
    }
    speakers.push_back(std::move(speaker));
  }
  for (const auto& leader : speakers) {
    for (const auto& other : speakers) {
      if (!leader.leads || other.leads) continue;
      for (const auto& tag : leader.tags) {
        if (std::find(other.tags.begin(), other.tags.end(), tag) != other.tags.end()) continue;
        deployment.findings.push_back(
            {Verdict::kWrongValue,
             "'" + leader.component->name + "' leads the dialogue in '" + tag + "', which '" +
                 other.component->name + "' does not know",
             !other.origin.empty() || leader.origin.empty() ? other.asked_at() : leader.origin});
      }
    }
  }
}

}  // namespace usher::operations
