#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <utility>
#include <vector>

#include "runtime/api/ports.hpp"
#include "runtime/engine/heart.hpp"
#include "runtime/engine/transport.hpp"

namespace usher::runtime {

class EngineOutput;

/// What the running handler has published and what leaves together when it returns.
class Outbox {
 public:
  /// More samples out of one handler are a programming error (std::length_error, which is a fault).
  static constexpr std::size_t kMaxStaged = 4096;

  void stage(EngineOutput& output, std::shared_ptr<const Bytes> cdr);
  void release();
  void drop() { staged_.clear(); }

 private:
  struct Staged {
    EngineOutput* output;
    std::shared_ptr<const Bytes> cdr;
  };
  std::vector<Staged> staged_;
};

/// An output whose writer is opened when the component is made.
class EngineOutput final : public OutputPort {
 public:
  EngineOutput(OutputDeclaration declaration, Outbox& outbox)
      : declaration_(std::move(declaration)), outbox_(&outbox) {}

  void open(Transport& transport) { writer_ = &transport.open_writer(declaration_); }
  topics::Scope scope() const { return declaration_.scope; }
  /// Nothing where it was not opened, as ports of the fleet of a robot that is in none.
  void write(std::shared_ptr<const Bytes> cdr) {
    if (writer_ != nullptr && !writer_->write(std::move(cdr))) ++not_written_;
  }
  /// Adds to the heartbeat's counters what was not written since the last call.
  void report_counts(Heart& heart) {
    if (not_written_ == 0) return;
    heart.counter(declaration_.topic + ": not written") += std::exchange(not_written_, 0);
  }

  void publish(const void* message) override;
  std::size_t reader_count() const override { return writer_ ? writer_->reader_count() : 0; }
  Guid guid() const override { return writer_ ? writer_->guid() : Guid{}; }

 private:
  std::shared_ptr<Bytes> free_buffer();

  OutputDeclaration declaration_;
  Outbox* outbox_;
  Transport::Writer* writer_ = nullptr;
  std::uint64_t not_written_ = 0;
  std::vector<std::shared_ptr<Bytes>> buffers_;  ///< used again when nobody else holds them
};

}  // namespace usher::runtime
