#include "runtime/lockstep/lockstep_host.hpp"

#include <algorithm>
#include <utility>

namespace usher::runtime {

/// There are no devices in simulation: every opening ends with a close.
class LockstepHost::DeadStream final : public Stream {
 public:
  DeadStream(std::string uri, StreamSink sink,
             std::function<void(Duration, std::function<void()>)> later)
      : uri_(std::move(uri)), sink_(std::move(sink)), later_(std::move(later)) {}

  void close() { sink_.closed("there are no devices in simulation: " + uri_); }

  bool write(std::span<const std::uint8_t> /*bytes*/) override { return false; }
  bool write_latest(std::span<const std::uint8_t> /*bytes*/) override { return false; }
  bool open() const override { return false; }
  void reopen(Duration delay) override {
    constexpr Duration kShortest = std::chrono::milliseconds(1);
    later_(std::max(delay, kShortest), [this] { close(); });
  }

 private:
  std::string uri_;
  StreamSink sink_;
  std::function<void(Duration, std::function<void()>)> later_;
};

/// A line to a scripted device.
class LockstepHost::LiveStream final : public Stream {
 public:
  LiveStream(LockstepDevice& device, StreamSink sink, std::function<Time()> now,
             std::function<void(Duration, std::function<void()>)> later)
      : device_(device), sink_(std::move(sink)), now_(std::move(now)), later_(std::move(later)) {}

  void run() {
    later_(kAsk, [this] {
      ask();
      run();
    });
  }
  bool write(std::span<const std::uint8_t> bytes) override {
    if (!open_) return false;
    if (Bytes answer = device_.answer(bytes); !answer.empty()) {
      later_(kWay, [this, answer = std::move(answer)] {
        if (open_) static_cast<void>(sink_.received(answer));
      });
    }
    return true;
  }
  bool write_latest(std::span<const std::uint8_t> bytes) override { return write(bytes); }
  bool open() const override { return open_; }
  void reopen(Duration delay) override {
    const bool was_open = std::exchange(open_, false);
    open_at_ = now_() + delay;
    if (was_open) later_(kWay, [this] { sink_.closed("reopened by the component"); });
  }
  void last_will(std::span<const std::uint8_t> message, Duration lasts) override {
    device_.last_will(message, lasts);
  }

 private:
  static constexpr auto kAsk = std::chrono::milliseconds(10);
  static constexpr auto kWay = std::chrono::milliseconds(1);
  static constexpr auto kAgain = std::chrono::seconds(1);

  void ask() {
    if (open_ && !device_.plugged) {
      open_ = false;
      open_at_ = now_() + kAgain;
      sink_.closed("unplugged");
    } else if (!device_.plugged) {
      open_at_ = now_() + kAgain;
    } else if (!open_ && now_() >= open_at_) {
      open_ = true;
      device_.opened();
      sink_.opened();
    } else if (open_) {
      if (const Bytes said = device_.speak(now_()); !said.empty())
        static_cast<void>(sink_.received(said));
    }
  }

  LockstepDevice& device_;
  StreamSink sink_;
  std::function<Time()> now_;
  std::function<void(Duration, std::function<void()>)> later_;
  bool open_ = false;
  Time open_at_{};
};

/// Everything that a kill -9 takes away.
class LockstepHost::Life final : public Platform, public Transport {
 public:
  Life(LockstepHost& host, Network::ParticipantId participant)
      : id(participant), engine(host.file_, *this, *this), host_(host) {}

  // --- Platform
  Time now() const override { return host_.schedule_.now() + clock(); }
  /// The engine asks before and after each handler.
  Duration work_time() const override { return host_.options_.handler_cost * (asked_++); }
  void wake() override {
    if (!host_.in_turn_) host_.plan_turn(host_.schedule_.now());
  }
  Resources resources() override { return {}; }
  void offload(Duration declared, std::function<void()> job,
               std::function<void()> finished) override {
    worker_free_ = std::max(worker_free_, host_.schedule_.now()) + declared;
    add_action(worker_free_, [job = std::move(job), finished = std::move(finished)] {
      job();
      finished();
    });
  }
  Stream& open_stream(const std::string& uri, StreamSink sink) override {
    auto later = [this](Duration delay, std::function<void()> action) {
      add_action(host_.schedule_.now() + delay, std::move(action));
    };
    if (host_.options_.device) {
      LiveStream& live = lines_.emplace_back(
          *host_.options_.device, std::move(sink), [this] { return now(); }, std::move(later));
      live.run();
      return live;
    }
    DeadStream& stream = streams_.emplace_back(uri, std::move(sink), std::move(later));
    stream.close();
    return stream;
  }
  Status keep(const std::string& key, std::span<const std::uint8_t> bytes) override {
    host_.kept_[key].assign(bytes.begin(), bytes.end());
    return {};
  }
  Result<std::optional<Bytes>> kept(const std::string& key) override {
    if (host_.unreadable_.contains(key))
      return Error{"cannot read " + key + ": Input/output error"};
    const auto found = host_.kept_.find(key);
    return found == host_.kept_.end() ? std::nullopt : std::optional(found->second);
  }

  // --- Transport
  Reader& open_reader(const InputDeclaration& declaration, Deliver deliver) override {
    return host_.network_.open_reader(id, declaration, std::move(deliver));
  }
  Writer& open_writer(const OutputDeclaration& declaration) override {
    return writers_.emplace_back(*this, host_.network_.open_writer(id, declaration));
  }
  void watch_writers(const std::string& topic,
                     std::function<void(const WriterInfo&)> event) override {
    host_.network_.watch_writers(id, topic, std::move(event));
  }

  /// What this life asked for later and that dies with it.
  void add_action(Time at, std::function<void()> action) {
    host_.schedule_.add_action(at,
                               [alive = std::weak_ptr<int>(alive_), action = std::move(action)] {
                                 if (!alive.expired()) action();
                               });
  }
  void begin_turn() { asked_at_turn_ = asked_; }
  /// How long the handlers of this turn took so far, the running one included.
  Duration spent() const {
    return host_.options_.handler_cost * ((asked_ - asked_at_turn_ + 1) / 2);
  }
  Time world_time(Time host) const { return host == Time::max() ? host : host - clock(); }

  const Network::ParticipantId id;

 private:
  /// Samples leave when the handler that wrote them returns.
  class LeavingWriter final : public Transport::Writer {
   public:
    LeavingWriter(Life& life, Transport::Writer& writer) : life_(&life), writer_(&writer) {}
    bool write(std::shared_ptr<const Bytes> cdr) override {
      const Time now = life_->host_.schedule_.now();
      life_->host_.network_.set_departure(life_->id, now + life_->spent());
      return writer_->write(std::move(cdr));
    }
    std::size_t reader_count() const override { return writer_->reader_count(); }
    Guid guid() const override { return writer_->guid(); }

   private:
    Life* life_;
    Transport::Writer* writer_;
  };

  std::shared_ptr<int> alive_ = std::make_shared<int>(0);
  std::deque<LeavingWriter> writers_;
  std::deque<DeadStream> streams_;
  std::deque<LiveStream> lines_;
  Time worker_free_{};
  mutable std::int64_t asked_ = 0;
  std::int64_t asked_at_turn_ = 0;

 public:
  Engine engine;  // after what it uses

 private:
  Duration clock() const { return host_.network_.clock_of(id); }

  LockstepHost& host_;
};

LockstepHost::LockstepHost(std::uint32_t index, Schedule& schedule, Network& network,
                           ComponentFactory factory, ParameterFile file, Options options)
    : index_(index),
      schedule_(schedule),
      network_(network),
      factory_(std::move(factory)),
      file_(std::move(file)),
      options_(std::move(options)) {}

LockstepHost::~LockstepHost() = default;

Engine* LockstepHost::engine() { return life_ ? &life_->engine : nullptr; }

Status LockstepHost::start() {
  if (life_) return Error{file_.name + " is already running"};
  ++lives_;
  busy_until_ = hung_until_ = Time{};
  life_ = std::make_unique<Life>(*this, network_.join(file_.name, file_.host, false, file_.robot));
  in_turn_ = true;
  Status status = life_->engine.construct(factory_);
  in_turn_ = false;
  if (!status.ok()) {
    fault_reason_ = status.error();
    end(true);
    return status;
  }
  network_.announce(life_->id);
  plan_turn(schedule_.now());
  return status;
}

void LockstepHost::end(bool politely) {
  planned_ = Time::max();
  if (politely) {
    network_.leave(life_->id);
  } else {
    network_.vanish(life_->id);
  }
  life_.reset();
}

void LockstepHost::kill() {
  if (!life_) return;
  end(false);
  if (options_.restart_after) restart_later(*options_.restart_after);
}

void LockstepHost::kill(Duration back_after) {
  if (!life_) return;
  end(false);
  restart_later(back_after);
}

void LockstepHost::stop() {
  if (!life_) return;
  life_->engine.stop();
  end(true);
}

void LockstepHost::restart_later(Duration delay) {
  schedule_.add_action(schedule_.now() + delay, [this] {
    if (!life_) static_cast<void>(start());  // the reason is kept in fault_reason_
  });
}

void LockstepHost::hang(Time until) { hung_until_ = std::max(hung_until_, until); }

void LockstepHost::clock_jumped() {
  if (life_) plan_turn(schedule_.now());
}

Time LockstepHost::earliest() const {
  return std::max({schedule_.now(), busy_until_, hung_until_});
}

void LockstepHost::plan_turn(Time at) {
  at = std::max(at, earliest());
  if (at >= planned_) return;
  planned_ = at;
  schedule_.add_turn(at, index_);
}

void LockstepHost::turn() {
  if (!life_ || planned_ != schedule_.now()) return;  // overtaken by an earlier one
  planned_ = Time::max();
  if (earliest() > schedule_.now()) {
    plan_turn(earliest());
    return;
  }
  in_turn_ = true;
  life_->begin_turn();
  const bool alive = life_->engine.run_turn();
  in_turn_ = false;
  if (!alive) {
    fault_reason_ = life_->engine.fault_reason();
    end(true);
    if (options_.restart_after) restart_later(*options_.restart_after);
    return;
  }
  busy_until_ = schedule_.now() + life_->spent();
  const Time due = life_->world_time(life_->engine.next_due());
  plan_turn(life_->engine.has_work() ? schedule_.now() : due);
}

}  // namespace usher::runtime
