#include "runtime/engine/engine.hpp"

#include <algorithm>
#include <deque>
#include <optional>
#include <stdexcept>
#include <tuple>
#include <utility>

#include "idl/topics.hpp"
#include "runtime/engine/heart.hpp"
#include "runtime/engine/inbox.hpp"
#include "runtime/engine/output_port.hpp"
#include "runtime/parameters/parameter_set.hpp"

namespace usher::runtime {
namespace {

constexpr Duration kCriticalHeartbeat = std::chrono::milliseconds(20);
constexpr Duration kHeartbeat = std::chrono::milliseconds(100);
/// How long handlers may take; a component that exceeds it again and again is degraded.
constexpr Duration kCriticalHandler = std::chrono::milliseconds(20);
constexpr Duration kHandler = std::chrono::milliseconds(100);

/// Ends a handler. Not an std::exception, so that a component that catches those does not go on.
struct HandlerEnded {};

/// The engine whose handler this thread runs; null: none.
thread_local const void* handling = nullptr;

/// Sets it for its scope.
class Handling {
 public:
  explicit Handling(const void* engine) : before_(std::exchange(handling, engine)) {}
  ~Handling() { handling = before_; }
  Handling(const Handling&) = delete;
  Handling& operator=(const Handling&) = delete;

 private:
  const void* before_;
};

class EngineInput final : public InputPort {
 public:
  EngineInput(InputDeclaration declaration, std::uint32_t order, const Time& now,
              std::uint32_t mailbox, const Inbox& inbox)
      : declaration_(std::move(declaration)),
        order_(order),
        now_(&now),
        mailbox_(mailbox),
        inbox_(&inbox) {}

  void open(Transport& transport, const std::shared_ptr<Inbox>& inbox) {
    reader_ = &transport.open_reader(
        declaration_,
        [inbox, mailbox = mailbox_](std::shared_ptr<const void> message, const Guid& writer,
                                    std::uint64_t number, bool same_host) {
          inbox->deliver(mailbox, std::move(message), writer, number, same_host);
        });
  }
  void start(Time start) { start_ = start; }

  /// The sample becomes the newest one; false for what no handler shall see: a sample of a writer
  /// that is not heard, and one that is too old when it comes.
  bool accept(Sample&& sample) {
    if (declaration_.one_writer && fresh() != nullptr &&
        latest_.info.writer != sample.info.writer) {
      ++unheard_;
      return false;
    }
    if (declaration_.each_writer) keep(sample);
    const bool late = !young(sample);
    if (late) ++late_;
    if (late && (fresh() != nullptr || !declaration_.late_too)) return false;
    latest_ = std::move(sample);
    if (!late) loss_reported_ = false;
    return true;
  }
  const InputDeclaration& declaration() const { return declaration_; }
  std::uint32_t order() const { return order_; }
  /// The first moment at which fresh() would say no, while that has not been reported.
  Time loss_due() const {
    if (declaration_.max_age <= Duration::zero() || loss_reported_ || reader_ == nullptr)
      return Time::max();
    const Time reference = latest_.message ? latest_.info.effective : start_;
    return reference + declaration_.max_age + Duration(1);
  }
  void report_loss() {
    loss_reported_ = true;
    if (declaration_.on_stale) declaration_.on_stale();
  }

  const Sample* latest() const override { return latest_.message ? &latest_ : nullptr; }
  const Sample* fresh() const override {
    return latest_.message && young(latest_) ? &latest_ : nullptr;
  }
  std::vector<const Sample*> fresh_of_each() const override {
    std::vector<const Sample*> all;
    for (const Sample& sample : newest_) {
      if (young(sample)) all.push_back(&sample);
    }
    return all;
  }
  std::vector<WriterInfo> writers() const override {
    return reader_ ? reader_->writers() : std::vector<WriterInfo>{};
  }
  std::uint64_t lost() const override { return inbox_->counts(mailbox_).lost; }
  std::uint64_t rejected() const override { return inbox_->counts(mailbox_).rejected; }

  /// Adds to the heartbeat's counters what came since the last call.
  void report_counts(Heart& heart) {
    const auto report = [&](const char* what, std::uint64_t count, std::uint64_t& reported) {
      if (count == reported) return;
      heart.counter(declaration_.topic + ": " + what) += count - reported;
      reported = count;
    };
    report("rejected", rejected(), rejected_reported_);
    report("lost", lost(), lost_reported_);
    report("from a second writer", unheard_, unheard_reported_);
    report("late", late_, late_reported_);
  }

 private:
  bool young(const Sample& sample) const {
    return declaration_.max_age <= Duration::zero() ||
           *now_ - sample.info.effective <= declaration_.max_age;
  }
  /// In the place of the writer's last one, at the end of the order.
  void keep(const Sample& sample) {
    std::erase_if(newest_, [&](const Sample& other) {
      return other.info.writer == sample.info.writer || !young(other);
    });
    if (newest_.size() == Engine::kMaxWriters) newest_.erase(newest_.begin());
    newest_.push_back(sample);
  }

  InputDeclaration declaration_;
  std::uint32_t order_;
  const Time* now_;
  std::uint32_t mailbox_;
  const Inbox* inbox_;
  std::vector<Sample> newest_;  ///< of each writer, where they are kept
  Transport::Reader* reader_ = nullptr;
  Sample latest_;
  Time start_{};
  bool loss_reported_ = false;
  std::uint64_t rejected_reported_ = 0, lost_reported_ = 0;
  std::uint64_t unheard_ = 0, unheard_reported_ = 0;
  std::uint64_t late_ = 0, late_reported_ = 0;
};

class EngineTimer final : public TimerPort {
 public:
  EngineTimer(TimerDeclaration declaration, std::uint32_t order, const Time& now)
      : declaration_(std::move(declaration)), order_(order), now_(&now) {
    restart(declaration_.period);
  }

  /// Counts anew from the moment at which the component is complete.
  void start(Time start) {
    if (next_ != Time::max()) next_ = start + period_;
  }
  const std::string& name() const { return declaration_.name; }
  std::uint32_t order() const { return order_; }
  Time due() const { return next_; }
  /// One call for everything that is due; the number of skipped periods.
  std::uint64_t advance() {
    const auto skipped = (*now_ - next_) / period_;
    next_ += (skipped + 1) * period_;
    return static_cast<std::uint64_t>(skipped);
  }
  void run(std::uint64_t skipped) const { declaration_.on_due(skipped); }

  void restart(Duration period) override {
    if (period < Duration::zero()) throw std::invalid_argument("period of a timer below zero");
    period_ = period;
    next_ = period == Duration::zero() ? Time::max() : *now_ + period;
  }
  void stop() override { next_ = Time::max(); }

 private:
  TimerDeclaration declaration_;
  std::uint32_t order_;
  const Time* now_;
  Duration period_{};
  Time next_ = Time::max();
};

/// A stream that is opened when the component is made.
class EngineStream final : public Stream {
 public:
  EngineStream(std::string uri, StreamHandlers handlers)
      : uri_(std::move(uri)), handlers_(std::make_shared<StreamHandlers>(std::move(handlers))) {}

  void open(Platform& platform, const std::shared_ptr<Inbox>& inbox) {
    StreamSink sink;
    sink.opened = [inbox, handlers = handlers_] {
      inbox->post([handlers] {
        if (handlers->on_open) handlers->on_open();
      });
    };
    sink.received = [inbox, handlers = handlers_,
                     waiting = std::make_shared<std::atomic<std::size_t>>(0)](
                        std::span<const std::uint8_t> bytes) {
      const std::size_t before = waiting->load();
      if (before > 0 && before + bytes.size() > Engine::kMaxStreamBytes) return false;
      waiting->fetch_add(bytes.size());
      inbox->post([handlers, waiting, content = Bytes(bytes.begin(), bytes.end())] {
        waiting->fetch_sub(content.size());
        if (handlers->on_bytes) handlers->on_bytes(content);
      });
      return true;
    };
    sink.closed = [inbox, handlers = handlers_](const std::string& reason) {
      inbox->post([handlers, reason] {
        if (handlers->on_close) handlers->on_close(reason);
      });
    };
    sink.guard = handlers_->guard;
    stream_ = &platform.open_stream(uri_, std::move(sink));
  }

  bool write(std::span<const std::uint8_t> bytes) override {
    return stream_ && stream_->write(bytes);
  }
  bool write_latest(std::span<const std::uint8_t> bytes) override {
    return stream_ && stream_->write_latest(bytes);
  }
  bool open() const override { return stream_ && stream_->open(); }
  void reopen(Duration delay) override {
    if (stream_) stream_->reopen(delay);
  }
  void last_will(std::span<const std::uint8_t> message, Duration lasts) override {
    if (stream_) stream_->last_will(message, lasts);
  }

 private:
  std::string uri_;
  std::shared_ptr<StreamHandlers> handlers_;
  Stream* stream_ = nullptr;
};

struct Watch {
  std::string topic;
  std::shared_ptr<std::function<void(const WriterInfo&)>> handler;
};

}  // namespace

class Engine::State {
 public:
  State(ParameterFile&& parameter_file, Platform& its_platform, Transport& its_transport)
      : file(std::move(parameter_file)),
        platform(its_platform),
        transport(its_transport),
        inbox(std::make_shared<Inbox>(its_platform, kMaxPosted, kMaxWriters)),
        heart(file.name, file.host, file.critical ? kCriticalHandler : kHandler),
        parameters(file.values, file.name) {}

  enum class Phase { kConstructing, kRunning, kEnded };

  void advance_clock() { now = std::max(now, platform.now()); }

  /// Runs a handler; what it published leaves if it returns without a fault.
  template <class Handler>
  bool run(const Handler& handler, const char* kind, const std::string& subject) {
    const Duration begin = platform.work_time();
    try {
      const Handling mark(this);
      handler();
      if (!fault) outbox.release();
    } catch (const HandlerEnded&) {
    } catch (const std::exception& error) {
      if (!fault) fault = std::string(kind) + subject + " threw: " + error.what();
    } catch (...) {
      if (!fault) fault = std::string(kind) + subject + " threw something";
    }
    if (fault) {
      end();
      return false;
    }
    heart.handler_took(platform.work_time() - begin, now, kind, subject);
    return true;
  }

  void open_ports() {
    const auto belongs = [this](topics::Scope scope) {
      return scope == topics::Scope::kRobot || !file.robot.empty();
    };
    for (EngineInput& input : inputs) {
      if (belongs(input.declaration().scope)) input.open(transport, inbox);
    }
    for (EngineOutput& output : outputs) {
      if (belongs(output.scope())) output.open(transport);
    }
    for (const Watch& watch : watches) {
      transport.watch_writers(watch.topic,
                              [inbox = inbox, handler = watch.handler](const WriterInfo& info) {
                                inbox->post([handler, info] { (*handler)(info); });
                              });
    }
    for (EngineStream& stream : streams) stream.open(platform, inbox);
  }

  void start() {
    advance_clock();
    for (EngineTimer& timer : timers) timer.start(now);
    for (EngineInput& input : inputs) input.start(now);
    next_heartbeat = now;
    phase = Phase::kRunning;
  }

  /// The component has ended with a fault: the last heartbeat leaves and nothing else.
  void end() {
    outbox.drop();
    phase = Phase::kEnded;
    inbox->close();
    heart.end(*fault);
    try {
      write_heartbeat();
    } catch (...) {
      outbox.drop();  // nothing left that could help
    }
  }

  void write_heartbeat() {
    if (!heartbeat_open) return;
    std::uint64_t lost = 0;
    for (EngineInput& input : inputs) {
      input.report_counts(heart);
      lost += input.lost();
    }
    for (EngineOutput& output : outputs) output.report_counts(heart);
    heartbeat.publish(heart.beat(now, platform.resources(), lost));
    outbox.release();
  }

  bool run_arrivals() {
    for (Arrival& arrival : batch) {
      if (arrival.order == Arrival::kPosted) continue;
      EngineInput& input = inputs[arrival.order - 1];
      if (!input.declaration().on_sample) input.accept(std::move(arrival.sample));
    }
    for (Arrival& arrival : batch) {
      bool alive = true;
      if (arrival.order == Arrival::kPosted) {
        ++handlers_run;
        alive = run(arrival.posted, "an event", "");
      } else if (EngineInput& input = inputs[arrival.order - 1]; input.declaration().on_sample) {
        if (!input.accept(std::move(arrival.sample))) continue;
        ++handlers_run;
        const auto handle = [&] { input.declaration().on_sample(*input.latest()); };
        alive = run(handle, "input ", input.declaration().topic);
      }
      if (!alive) return false;
    }
    return true;
  }

  /// Whatever runs first: a loss that is due, else the timer, loss or heartbeat of the least time.
  struct Due {
    Time time = Time::max();
    std::uint32_t order = 0;
    EngineTimer* timer = nullptr;
    EngineInput* input = nullptr;
  };
  Due first_due() {
    Due first;
    const auto consider = [&](Time time, std::uint32_t order, EngineTimer* timer,
                              EngineInput* input) {
      const bool lost = input != nullptr && time <= now;
      const bool first_lost = first.input != nullptr && first.time <= now;
      if (std::tuple(!lost, time, order) < std::tuple(!first_lost, first.time, first.order)) {
        first = {time, order, timer, input};
      }
    };
    for (EngineTimer& timer : timers) consider(timer.due(), timer.order(), &timer, nullptr);
    for (EngineInput& input : inputs) consider(input.loss_due(), input.order(), nullptr, &input);
    consider(next_heartbeat, UINT32_MAX, nullptr, nullptr);
    return first;
  }

  bool run_due() {
    // Each entry moves its due time past now when it runs, so this ends.
    for (Due due = first_due(); due.time <= now; due = first_due()) {
      if (due.timer != nullptr) {
        ++handlers_run;
        const std::uint64_t skipped = due.timer->advance();
        if (skipped > 0) heart.counter("timer " + due.timer->name() + ": skipped") += skipped;
        if (!run([&] { due.timer->run(skipped); }, "timer ", due.timer->name())) return false;
      } else if (due.input != nullptr) {
        ++handlers_run;
        if (!run([&] { due.input->report_loss(); }, "loss of ", due.input->declaration().topic)) {
          return false;
        }
      } else {
        const Duration period = file.critical ? kCriticalHeartbeat : kHeartbeat;
        next_heartbeat += ((now - next_heartbeat) / period + 1) * period;
        write_heartbeat();
      }
    }
    return true;
  }

  const ParameterFile file;
  Platform& platform;
  Transport& transport;
  std::shared_ptr<Inbox> inbox;
  Heart heart;
  ParameterSet parameters;
  Outbox outbox;

  Phase phase = Phase::kConstructing;
  Time now{};
  std::optional<std::string> fault;
  std::string wrong_declarations;
  std::uint32_t declarations = 0;
  std::deque<EngineInput> inputs;  // deques: ports keep their addresses
  std::deque<EngineOutput> outputs;
  std::deque<EngineTimer> timers;
  std::deque<EngineStream> streams;
  std::vector<Watch> watches;
  Output<usher_msgs::msg::Heartbeat> heartbeat;
  bool heartbeat_open = false;
  Time next_heartbeat{};
  std::vector<Arrival> batch;
  std::uint64_t handlers_run = 0;
  std::size_t jobs = 0;
  std::unique_ptr<Component> component;  // last: its end comes first
};

Engine::Engine(ParameterFile file, Platform& platform, Transport& transport)
    : state_(std::make_unique<State>(std::move(file), platform, transport)) {}

Engine::~Engine() { stop(); }

Status Engine::construct(const ComponentFactory& factory) {
  State& state = *state_;
  state.advance_clock();
  const auto make = [&] {
    try {
      state.component = factory.make(*this);
    } catch (const HandlerEnded&) {
    } catch (const std::exception& error) {
      if (!state.fault) state.fault = "the constructor threw: " + std::string(error.what());
    } catch (...) {
      if (!state.fault) state.fault = "the constructor threw something";
    }
    // Wrong parameters explain most faults of a constructor: they are told instead. One that did
    // not come to its end has not asked for all of them.
    Status parameters = state.parameters.finish(!state.fault);
    if (!parameters.ok()) return parameters;
    if (!state.wrong_declarations.empty()) return Status(Error{state.wrong_declarations});
    return Status();
  };
  Status status = make();
  if (!status.ok()) {
    state.fault.reset();
    state.outbox.drop();
    stop();
    return status;
  }
  state.heartbeat = output(topics::kHeartbeat);
  const auto open = [&] {
    if (!state.fault) {
      state.open_ports();
    } else {
      state.outputs.back().open(state.transport);  // the last heartbeat must be able to leave
    }
    state.heartbeat_open = true;
  };
  if (!state.run(open, "opening the ports", "")) return Error{*state.fault};
  state.start();
  return {};
}

bool Engine::has_work() const { return state_->inbox->has_work(); }

Time Engine::next_due() const {
  if (state_->phase != State::Phase::kRunning) return Time::max();
  return state_->first_due().time;
}

bool Engine::run_turn() {
  State& state = *state_;
  if (state.phase != State::Phase::kRunning) return false;
  const bool complete = state.inbox->take(state.batch);
  state.advance_clock();  // after taking: nothing in this turn comes from its future
  if (!complete) {
    fail("more than " + std::to_string(kMaxPosted) + " events were waiting");
    return false;
  }
  const bool alive = state.run_arrivals() && state.run_due();
  state.batch.clear();
  return alive;
}

void Engine::post(std::function<void()> handler) { state_->inbox->post(std::move(handler)); }

void Engine::fail(const std::string& reason) {
  if (state_->phase == State::Phase::kEnded) return;
  state_->fault = reason;
  state_->advance_clock();
  state_->end();
}

void Engine::stop() {
  state_->phase = State::Phase::kEnded;
  state_->inbox->close();
}

bool Engine::faulted() const { return state_->fault.has_value(); }

const std::string& Engine::fault_reason() const {
  static const std::string kNone;
  return state_->fault ? *state_->fault : kNone;
}

const ParameterFile& Engine::file() const { return state_->file; }
std::uint64_t Engine::handlers_run() const { return state_->handlers_run; }
Time Engine::now() const { return state_->now; }
const std::string& Engine::name() const { return state_->file.name; }
const std::string& Engine::host_name() const { return state_->file.host; }
const std::string& Engine::robot_name() const { return state_->file.robot; }
Parameters& Engine::parameters() { return state_->parameters; }
Health& Engine::health() { return state_->heart; }

Random Engine::random(std::string_view stream) {
  const std::string& robot = state_->file.robot;
  const std::uint64_t seed =
      robot.empty() ? state_->file.seed : stream_seed(state_->file.seed, robot.c_str());
  const std::uint64_t own = stream_seed(seed, state_->file.name.c_str());
  return Random(stream_seed(own, std::string(stream).c_str()));
}

void Engine::offload(Duration declared, std::function<void()> job, std::function<void()> done) {
  State& state = *state_;
  if (state.jobs == kMaxJobs) fault(std::to_string(kMaxJobs) + " offloaded jobs are under way");
  ++state.jobs;
  const auto error = std::make_shared<std::string>();
  auto guarded = [job = std::move(job), error] {
    try {
      job();
    } catch (const std::exception& exception) {
      *error = std::string("an offloaded job threw: ") + exception.what();
    } catch (...) {
      *error = "an offloaded job threw something";
    }
  };
  auto finish = [this, error, done = std::move(done)] {
    --state_->jobs;
    if (!error->empty()) fault(*error);
    done();
  };
  state.platform.offload(
      declared, std::move(guarded),
      [inbox = state.inbox, finish = std::move(finish)] { inbox->post(finish); });
}

Stream& Engine::open_stream(const std::string& uri, StreamHandlers handlers) {
  EngineStream& stream = state_->streams.emplace_back(uri, std::move(handlers));
  if (state_->phase == State::Phase::kRunning) stream.open(state_->platform, state_->inbox);
  return stream;
}

Status Engine::keep(const std::string& key, std::span<const std::uint8_t> bytes) {
  if (handling == state_.get())
    fault(key + " was kept in a handler: what it publishes would wait for the disk");
  constexpr std::size_t kLargest = 1 << 20;
  if (bytes.size() > kLargest) {
    return Error{"at most 1 MB can be kept, got " + std::to_string(bytes.size()) + " bytes (" +
                 key + ")"};
  }
  return state_->platform.keep(key, bytes);
}

Result<std::optional<Bytes>> Engine::kept(const std::string& key) {
  return state_->platform.kept(key);
}

void Engine::watch_writers(const std::string& topic,
                           std::function<void(const WriterInfo&)> handler) {
  if (state_->phase != State::Phase::kConstructing) {
    fault("writers of " + topic + " were watched after the constructor");
  }
  state_->watches.push_back(
      {topic, std::make_shared<std::function<void(const WriterInfo&)>>(std::move(handler))});
}

void Engine::fault(const std::string& reason) {
  if (!state_->fault) state_->fault = reason;
  throw HandlerEnded{};
}

InputPort& Engine::declare(InputDeclaration declaration) {
  State& state = *state_;
  if (state.phase != State::Phase::kConstructing) {
    fault("input " + declaration.topic + " was declared after the constructor");
  }
  const auto wrong = [&](const char* what) {
    if (!state.wrong_declarations.empty()) state.wrong_declarations += '\n';
    state.wrong_declarations += "programming error: input " + declaration.topic + what;
  };
  if (declaration.max_age > Duration::zero() && declaration.on_loss.empty())
    wrong(" has an age but does not say what its loss means");
  if (declaration.max_age <= Duration::zero() && declaration.one_writer)
    wrong(" has one writer but no age that would end its right");
  if (declaration.max_age <= Duration::zero() && declaration.late_too)
    wrong(" takes late samples but has no age after which they are late");
  const std::uint32_t mailbox = state.inbox->add_input(declaration);
  return state.inputs.emplace_back(std::move(declaration), state.declarations++, state.now, mailbox,
                                   *state.inbox);
}

OutputPort& Engine::declare(OutputDeclaration declaration) {
  State& state = *state_;
  if (state.phase != State::Phase::kConstructing) {
    fault("output " + declaration.topic + " was declared after the constructor");
  }
  ++state.declarations;
  return state.outputs.emplace_back(std::move(declaration), state.outbox);
}

TimerPort& Engine::declare(TimerDeclaration declaration) {
  State& state = *state_;
  if (state.phase != State::Phase::kConstructing) {
    fault("timer " + declaration.name + " was declared after the constructor");
  }
  return state.timers.emplace_back(std::move(declaration), state.declarations++, state.now);
}

}  // namespace usher::runtime
