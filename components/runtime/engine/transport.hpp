#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "runtime/api/ports.hpp"

namespace usher::runtime {

/// What an Engine needs of the world that carries samples: Fast DDS (runtime/dds) or the lockstep
/// simulation (runtime/lockstep). Ports live until the transport is destroyed.
class Transport {
 public:
  /// Takes one received sample; may be called on any thread. `message` is null when the bytes were
  /// not a message of the declared type (the engine counts it as rejected).
  using Deliver = std::function<void(std::shared_ptr<const void> message, const Guid& writer,
                                     std::uint64_t number, bool same_host)>;

  class Reader {
   public:
    virtual ~Reader() = default;
    virtual std::vector<WriterInfo> writers() const = 0;  ///< matched and alive
  };
  class Writer {
   public:
    virtual ~Writer() = default;
    /// False when it was not taken; the transport says why.
    virtual bool write(std::shared_ptr<const Bytes> cdr) = 0;
    virtual std::size_t reader_count() const = 0;
    virtual Guid guid() const = 0;
  };

  virtual ~Transport() = default;
  virtual Reader& open_reader(const InputDeclaration& declaration, Deliver deliver) = 0;
  virtual Writer& open_writer(const OutputDeclaration& declaration) = 0;
  /// Every writer of the topic that discovery sees, of whatever type and quality; any thread.
  virtual void watch_writers(const std::string& topic,
                             std::function<void(const WriterInfo&)> event) = 0;
};

}  // namespace usher::runtime
