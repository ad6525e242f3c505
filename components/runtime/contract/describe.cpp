#include "runtime/contract/describe.hpp"

#include <deque>
#include <iomanip>
#include <memory>
#include <optional>
#include <sstream>

#include "idl/topics.hpp"
#include "runtime/parameters/parameter_set.hpp"

namespace usher::runtime {
namespace {

/// Not an std::exception, so that a constructor which catches those cannot go on.
struct ConstructorEnded {};

class NoInput final : public InputPort {
 public:
  const Sample* latest() const override { return nullptr; }
  const Sample* fresh() const override { return nullptr; }
  std::vector<const Sample*> fresh_of_each() const override { return {}; }
  std::vector<WriterInfo> writers() const override { return {}; }
  std::uint64_t lost() const override { return 0; }
  std::uint64_t rejected() const override { return 0; }
};

class NoOutput final : public OutputPort {
 public:
  void publish(const void* /*message*/) override {}
  std::size_t reader_count() const override { return 0; }
  Guid guid() const override { return {}; }
};

class NoTimer final : public TimerPort {
 public:
  void restart(Duration /*period*/) override {}
  void stop() override {}
};

class NoStream final : public Stream {
 public:
  bool write(std::span<const std::uint8_t> /*bytes*/) override { return false; }
  bool write_latest(std::span<const std::uint8_t> /*bytes*/) override { return false; }
  bool open() const override { return false; }
  void reopen(Duration /*delay*/) override {}
};

class NoHealth final : public Health {
 public:
  void set(HealthState /*state*/, std::string /*reason*/) override {}
  std::uint64_t& counter(const std::string& /*name*/) override { return count_; }

 private:
  std::uint64_t count_ = 0;
};

class DescribeHost final : public Host {
 public:
  explicit DescribeHost(const std::string& type)
      : name_(type), parameters_({}, type, ParameterSet::Missing::kIsFine) {
    contract_.component = type;
  }
  explicit DescribeHost(const ParameterFile& file)
      : name_(file.name),
        host_name_(file.host),
        robot_name_(file.robot),
        parameters_(file.values, file.name) {}

  Result<Contract> describe(const ComponentFactory& factory) {
    if (auto error = construct(factory))
      return Error{name_ + " cannot be constructed with its defaults: " + *error};
    output(topics::kHeartbeat);
    const Status status = parameters_.finish();
    if (!status.ok()) return Error{name_ + ": " + status.error()};
    if (!wrong_.empty()) return Error{name_ + ": " + wrong_};
    contract_.parameters = parameters_.declared();
    contract_.version = USHER_VERSION;
    std::ostringstream digest;
    digest << std::hex << std::setw(16) << std::setfill('0') << USHER_IDL_DIGEST;
    contract_.idl_digest = digest.str();
    return std::move(contract_);
  }

  Status judge(const ComponentFactory& factory) {
    auto refusal = construct(factory);
    if (!refusal) refusal = fault_;
    // A value that cannot be read comes first: the constructor got another one in its place.
    if (Status status = parameters_.finish(!refusal); !status) return status;
    if (refusal) return Error{*refusal};
    return {};
  }

  Time now() const override { return {}; }
  const std::string& name() const override { return name_; }
  const std::string& host_name() const override { return host_name_; }
  const std::string& robot_name() const override { return robot_name_; }
  Parameters& parameters() override { return parameters_; }
  Health& health() override { return health_; }
  Random random(std::string_view /*stream*/) override { return Random(1); }
  void offload(Duration, std::function<void()>, std::function<void()>) override {}
  Stream& open_stream(const std::string&, StreamHandlers) override { return stream_; }
  Status keep(const std::string&, std::span<const std::uint8_t>) override { return {}; }
  Result<std::optional<Bytes>> kept(const std::string&) override { return std::optional<Bytes>(); }
  void watch_writers(const std::string&, std::function<void(const WriterInfo&)>) override {}
  [[noreturn]] void fault(const std::string& reason) override {
    fault_ = reason;
    throw ConstructorEnded{};
  }

 protected:
  InputPort& declare(InputDeclaration declaration) override {
    if (declaration.max_age > Duration::zero() && declaration.on_loss.empty()) {
      wrong_ += "input " + declaration.topic + " has an age but does not say what its loss means; ";
    }
    contract_.inputs.push_back({declaration.topic, std::string(declaration.type->name),
                                declaration.on_loss, declaration.qos, declaration.rate_hz,
                                seconds(declaration.max_age), declaration.optional,
                                declaration.scope});
    return input_;
  }
  OutputPort& declare(OutputDeclaration declaration) override {
    contract_.outputs.push_back({declaration.topic, std::string(declaration.type->name),
                                 declaration.qos, declaration.rate_hz, declaration.scope});
    return output_;
  }
  TimerPort& declare(TimerDeclaration declaration) override {
    contract_.timers.push_back({declaration.name, seconds(declaration.period)});
    return timer_;
  }

 private:
  /// What else than a fault ended the constructor.
  std::optional<std::string> construct(const ComponentFactory& factory) {
    try {
      factory.make(*this);
    } catch (const ConstructorEnded&) {
    } catch (const std::exception& error) {
      return error.what();
    }
    return std::nullopt;
  }

  std::string name_, host_name_ = "localhost", robot_name_, wrong_;
  std::optional<std::string> fault_;
  ParameterSet parameters_;
  NoHealth health_;
  NoStream stream_;
  NoInput input_;
  NoOutput output_;
  NoTimer timer_;
  Contract contract_;
};

}  // namespace

Result<Contract> describe(const ComponentFactory& factory) {
  return DescribeHost(factory.type).describe(factory);
}

Status judge(const ComponentFactory& factory, const ParameterFile& file) {
  return DescribeHost(file).judge(factory);
}

}  // namespace usher::runtime
