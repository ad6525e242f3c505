#pragma once

#include <cstddef>
#include <memory>
#include <vector>

#include "runtime/api/ports.hpp"
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
    if (writer_ != nullptr) writer_->write(std::move(cdr));
  }

  void publish(const void* message) override;
  std::size_t reader_count() const override { return writer_ ? writer_->reader_count() : 0; }
  Guid guid() const override { return writer_ ? writer_->guid() : Guid{}; }

 private:
  std::shared_ptr<Bytes> free_buffer();

  OutputDeclaration declaration_;
  Outbox* outbox_;
  Transport::Writer* writer_ = nullptr;
  std::vector<std::shared_ptr<Bytes>> buffers_;  ///< used again when nobody else holds them
};

}  // namespace usher::runtime
