#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "drivers/base_obedience/core/base_obedience.hpp"

namespace usher::drive {

/// A writer of a topic as discovery sees it.
struct WriterSighting {
  WriterId writer{};
  std::string participant;  ///< its name, self-declared
  std::string host;         ///< self-declared
};

/// A component of the manifest.
struct NamedComponent {
  std::string name;
  std::string type;
};

/// Who may write a topic: the names of the components whose type, or whose simulated variant, is
/// among `types` (words of the catalogue, separated by spaces), and the operator where that word is
/// there.
std::vector<std::string> allowed_writers(std::string_view types,
                                         const std::vector<NamedComponent>& manifest);

/// Finds who may write a topic that moves the robot, and whoever else tries to.
///
/// For each allowed name the holder of the right is the first live writer whose participant has it.
/// Any writer of another name is foreign. A second writer of an allowed name may be the restart of
/// a holder that died and whose end discovery has not noticed yet: it waits until the holder is
/// seen dead, and is foreign as soon as the holder shows life while both are there.
///
/// The list is bounded; looking is linear in it. Allocates only in appeared().
class WriterRight {
 public:
  enum class Role { kHolder, kWaiting, kForeign };
  struct Known {
    WriterSighting sighting;
    Time since{};
    Role role = Role::kForeign;
    std::optional<Time> heard_at{};  ///< last sign of life, of a holder
  };

  /// A sign of life that comes within `slack` after the second writer appeared may have been under
  /// way when the holder died.
  explicit WriterRight(std::vector<std::string> participants,
                       Time slack = std::chrono::milliseconds(50));

  void appeared(const WriterSighting& sighting, Time now);
  /// Discovery lost the writer, or the launcher says that its process ended.
  void gone(const WriterId& writer);
  /// Any message of the participant that owns `writer` arrived.
  void alive(const WriterId& writer, Time now);

  /// Whether the writer holds the right of its name.
  bool holds(const WriterId& writer) const;
  /// Whether it is who its name says as far as is known: it holds the right of the name or waits
  /// for it, and nobody there was unmasked who claims that name too. Of two who live, which is the
  /// liar cannot be told from the order in which they were met.
  bool trusted(const WriterId& writer) const;
  /// Of the first allowed name that has a holder, in the order of appearance; who may write where
  /// one name is allowed.
  std::optional<WriterId> holder() const;

  /// Whether holder() is somebody who was not heard for so long, or never, while a second one of
  /// its name waits: it died, and discovery has not noticed it yet.
  bool doubted(Time now, Time silence) const;

  /// The oldest writer that must not be there; null when there is none.
  const WriterSighting* foreign() const;

  /// Everybody that is there, in order of appearance.
  const std::vector<Known>& writers() const { return known_; }

 private:
  static constexpr std::size_t kMostWriters = 64;  ///< more who are foreign are not listed

  bool allows(const std::string& participant) const;
  const Known* holder_of(const std::string& participant) const;

  std::vector<std::string> participants_;
  Time slack_;
  std::vector<Known> known_;  ///< in order of appearance
  std::size_t unlisted_ = 0;  ///< foreign ones that are there and have no place in the list
};

}  // namespace usher::drive
