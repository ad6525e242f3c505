#include "operations/command_line/judging.hpp"

#include <sys/mman.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cctype>
#include <cstdio>
#include <iostream>
#include <string>

#include "foundation/result/result.hpp"
#include "operations/launcher/launcher.hpp"

namespace usher::operations {

namespace {

std::string quoted(const std::string& word) {
  std::string result = "'";
  for (const char c : word) result += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return result + "'";
}

/// A file in memory that programs started from here can open, as long as this lives.
class PassedFile {
 public:
  explicit PassedFile(const std::string& content) : descriptor_(::memfd_create("parameters", 0)) {
    whole_ = ::write(descriptor_, content.data(), content.size()) ==
             static_cast<ssize_t>(content.size());
  }
  ~PassedFile() { ::close(descriptor_); }
  PassedFile(const PassedFile&) = delete;
  PassedFile& operator=(const PassedFile&) = delete;

  bool whole() const { return whole_; }
  std::string path() const { return "/proc/self/fd/" + std::to_string(descriptor_); }

 private:
  int descriptor_;
  bool whole_ = false;
};

/// What the program refuses is an error: its last line, without its name before it.
Status ask(const std::string& program, const runtime::ParameterFile& parameters) {
  constexpr int kRefuses = 2, kTooSlow = 124;
  constexpr std::size_t kMostWords = 1U << 16U;
  const PassedFile file(to_yaml(parameters));
  const std::string line =
      "timeout 20 " + quoted(program) + " --judge --parameters " + file.path() + " 2>&1";
  std::FILE* said = file.whole() ? ::popen(line.c_str(), "r") : nullptr;
  if (said == nullptr) return Error{"its program could not be started"};
  std::string words;
  for (int c = std::fgetc(said); c != EOF; c = std::fgetc(said)) {
    if (words.size() < kMostWords) words.push_back(static_cast<char>(c));
  }
  const int status = ::pclose(said);
  if (WIFEXITED(status) && WEXITSTATUS(status) == 0) return {};
  while (words.ends_with('\n')) words.pop_back();
  words.erase(0, words.rfind('\n') + 1);
  const std::string name = parameters.name + ": ";
  if (words.starts_with(name)) words.erase(0, name.size());
  const int code = WIFEXITED(status) ? WEXITSTATUS(status) : -1;
  if (code == kRefuses) return Error{words};
  if (code == kTooSlow) return Error{"its program gave no answer within 20 s"};
  return Error{"its program ended with " + std::to_string(code) +
               " instead of an answer: " + words};
}

bool is_part_of_a_name(char c) {
  return std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '_';
}

/// Whether a text has this name, and not as a part of a longer one.
bool names(const std::string& text, const std::string& name) {
  for (auto at = text.find(name); at != std::string::npos; at = text.find(name, at + 1)) {
    const auto end = at + name.size();
    if ((at == 0 || !is_part_of_a_name(text[at - 1])) &&
        (end == text.size() || !is_part_of_a_name(text[end])))
      return true;
  }
  return false;
}

/// Where the value that the refusal names was set; where the component is declared if it names
/// none.
const std::string& origin_of(const std::string& refusal, const runtime::ParameterFile& file,
                             const ManifestComponent& component) {
  const runtime::ParameterValue* named = nullptr;
  for (const auto& value : file.values) {
    const bool longer = named == nullptr || value.name.size() > named->name.size();
    if (longer && names(refusal, value.name)) named = &value;
  }
  return named == nullptr || named->origin.empty() ? component.origin : named->origin;
}

}  // namespace

std::vector<Finding> judge_by_components(const Deployment& deployment,
                                         const Installation& installation) {
  std::vector<Finding> findings;
  std::string not_asked;
  for (std::size_t i = 0; i < deployment.files.size(); ++i) {
    const ManifestComponent& component = deployment.manifest.components[i];
    const std::string program = installation.programs + "/usher-" + component.type;
    if (::access(program.c_str(), X_OK) != 0) {
      not_asked += (not_asked.empty() ? "" : ", ") + component.name;
      continue;
    }
    const runtime::ParameterFile& file = deployment.files[i];
    if (const Status status = ask(program, file); !status) {
      findings.push_back(finding_of(Verdict::kWrongValue,
                                    "'" + component.name + "' refuses: " + status.error(),
                                    origin_of(status.error(), file, component)));
    }
  }
  if (!not_asked.empty())
    std::cerr << "usher: not asked what they refuse, since their programs are not in "
              << installation.programs << ": " << not_asked << "\n";
  return findings;
}

}  // namespace usher::operations
