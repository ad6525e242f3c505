#include "operations/manifest/dialogue.hpp"

#include <algorithm>
#include <filesystem>
#include <span>
#include <string_view>

#include "interaction/phrases/core/phrase_file.hpp"
#include "interaction/speech/core/conversation.hpp"
#include "interaction/tablet/core/tablet.hpp"
#include "operations/manifest/setting.hpp"
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
    if (section == std::end(kSections) || !contracts.contains(components[i].type)) continue;
    const auto texts = setting(contracts, deployment, i, "texts").value_or(Setting{});
    const auto languages = setting(contracts, deployment, i, "languages").value_or(Setting{});
    const std::filesystem::path file = texts.value.text;
    std::error_code ignored;
    if (!file.empty() && !std::filesystem::is_regular_file(file, ignored))
      continue;  // found before
    Speaker speaker{&components[i], section->leads, phrases::tags_of(languages.value.text),
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
