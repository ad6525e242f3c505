#include "runtime/engine/output_port.hpp"

#include <atomic>
#include <new>
#include <stdexcept>
#include <utility>

namespace usher::runtime {

void Outbox::stage(EngineOutput& output, std::shared_ptr<const Bytes> cdr) {
  if (staged_.size() == kMaxStaged) throw std::length_error("a handler published too many samples");
  staged_.push_back({&output, std::move(cdr)});
}

void Outbox::release() {
  for (Staged& staged : staged_) staged.output->write(std::move(staged.cdr));
  staged_.clear();
}

std::shared_ptr<Bytes> EngineOutput::free_buffer() {
  constexpr std::size_t kMaxBuffers = 8;
  for (const auto& buffer : buffers_) {
    if (buffer.use_count() != 1) continue;
    std::atomic_thread_fence(std::memory_order_acquire);  // after the last reader's release
    return buffer;
  }
  auto buffer = std::make_shared<Bytes>();
  if (buffers_.size() < kMaxBuffers) buffers_.push_back(buffer);
  return buffer;
}

void EngineOutput::publish(const void* message) {
  auto buffer = free_buffer();
  if (!declaration_.type->serialize(message, *buffer)) throw std::bad_alloc();
  outbox_->stage(*this, std::move(buffer));
}

}  // namespace usher::runtime
