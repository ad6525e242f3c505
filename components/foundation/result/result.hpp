#pragma once

#include <cassert>
#include <string>
#include <utility>
#include <variant>

namespace usher {

/// Why an operation failed: what was expected, what was found, and where (file:line or topic).
struct Error {
  std::string message;
};

/// A value or the reason why there is none. Operating errors are values; broken contracts are
/// assertions.
template <class T>
class [[nodiscard]] Result {
 public:
  Result(T value)
      : content_(std::in_place_index<0>, std::move(value)) {}  // NOLINT: implicit by design
  Result(Error error)
      : content_(std::in_place_index<1>, std::move(error)) {}  // NOLINT: implicit by design

  bool ok() const { return content_.index() == 0; }
  explicit operator bool() const { return ok(); }

  /// The value; calling it on an error is a programming error.
  const T& value() const& { return assert(ok()), std::get<0>(content_); }
  T& value() & { return assert(ok()), std::get<0>(content_); }
  T&& value() && { return assert(ok()), std::get<0>(std::move(content_)); }
  const T& operator*() const& { return value(); }
  T& operator*() & { return value(); }
  const T* operator->() const { return &value(); }
  T* operator->() { return &value(); }

  /// The reason; calling it on a value is a programming error.
  const std::string& error() const { return assert(!ok()), std::get<1>(content_).message; }

 private:
  std::variant<T, Error> content_;
};

/// Success or the reason of the failure.
class [[nodiscard]] Status {
 public:
  Status() = default;
  Status(Error error)
      : message_(std::move(error.message)), ok_(false) {}  // NOLINT: implicit by design

  bool ok() const { return ok_; }
  explicit operator bool() const { return ok_; }
  const std::string& error() const { return assert(!ok_), message_; }

 private:
  std::string message_;
  bool ok_ = true;
};

}  // namespace usher
