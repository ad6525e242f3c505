#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>
#include <numbers>

#include "idl/topics.hpp"
#include "runtime/contract/describe.hpp"

namespace usher::runtime {
namespace {

using ::testing::HasSubstr;

/// One of everything.
class Sample final : public Component {
 public:
  explicit Sample(Host& host) {
    auto& parameters = host.parameters();
    parameters.flag("polite", true, "Whether it says please.");
    parameters.integer("beams", "-", {1, 1000}, 60, "How many.");
    parameters.number("angle", "rad", {-4, 4}, std::numbers::pi / 9, "How far.");
    parameters.number("limit", "m/s", {0, std::numeric_limits<double>::infinity()}, 1.5,
                      "How fast.");
    parameters.number("robot.width", "m", {0.1, 2}, "How wide.");
    parameters.text("greeting", "hello: \"you\" # there", "What it says.");
    parameters.choice("model", {"beam", "field"}, "field", "Which.");
    parameters.file("map", "", "Where it is.");
    parameters.numbers("weights", "-", {0, 1}, 2, 4, {0.5, 0.25}, "How much.");
    parameters.records("mounts",
                       {{"name", ParameterKind::kText, "-", {}, "Who."},
                        {"x", ParameterKind::kNumber, "m", {-1, 1}, "Where."}},
                       "All of them.");
    host.input(
        topics::kScan, {std::chrono::milliseconds(250), "it stops"},
        [](const auto&, const auto&) {}, [] {});
    host.input(topics::kMap, {.optional = true});
    host.input(topics::kHeartbeat, {.depth = 128});
    host.output(topics::kAmclPose);
    host.timer("step", std::chrono::milliseconds(20), [](auto) {});
    host.timer("stopped", Duration::zero(), [](auto) {});
    host.watch_writers("drive/command", [](const auto&) {});
    EXPECT_FALSE(host.kept("pose").value());
    EXPECT_FALSE(host.open_stream("tcp://nowhere:1", {}).open());
    host.offload(
        Duration(1), [] { ADD_FAILURE() << "describing runs no job"; }, [] {});
  }
};

TEST(Describe, RecordsEverythingThatAComponentDeclares) {
  const auto contract = describe(component_factory<Sample>("sample"));
  ASSERT_TRUE(contract.ok()) << contract.error();
  EXPECT_EQ(contract->component, "sample");
  EXPECT_FALSE(contract->version.empty());
  ASSERT_EQ(contract->inputs.size(), 3U);
  EXPECT_EQ(contract->inputs[0].topic, "scan");
  EXPECT_EQ(contract->inputs[0].type, "sensor_msgs::msg::dds_::LaserScan_");
  EXPECT_EQ(contract->inputs[0].on_loss, "it stops");
  EXPECT_EQ(contract->inputs[0].max_age, 0.25);
  EXPECT_EQ(contract->inputs[0].rate_hz, 50.0);
  EXPECT_EQ(contract->inputs[0].qos, (Qos{false, false, 5}));
  EXPECT_TRUE(contract->inputs[1].optional);
  EXPECT_EQ(contract->inputs[2].qos.depth, 128);
  ASSERT_EQ(contract->outputs.size(), 2U);
  EXPECT_EQ(contract->outputs[0].qos, (Qos{true, true, 1}));
  EXPECT_EQ(contract->outputs[1].topic, "heartbeat");
  ASSERT_EQ(contract->parameters.size(), 10U);
  EXPECT_EQ(contract->parameters[2].fallback, "20 deg");
  EXPECT_EQ(contract->parameters[3].fallback, "1.5 m/s");
  EXPECT_TRUE(contract->parameters[4].required);
  EXPECT_EQ(contract->parameters[8].fallback, "[0.5, 0.25]");
  EXPECT_EQ(contract->parameters[8].count_max, 4U);
  ASSERT_EQ(contract->timers.size(), 2U);
  EXPECT_EQ(contract->timers[0].period, 0.02);
}

/// Refuses two values that it would take each by itself.
class Particular final : public Component {
 public:
  explicit Particular(Host& host) {
    auto& parameters = host.parameters();
    const double near = parameters.number("near", "m", {0, 9}, 1.0, "How near.");
    const double far = parameters.number("far", "m", {0, 9}, "How far.");
    if (near >= far) host.fault(host.name() + " on " + host.host_name() + ": near before far");
  }
};

Status judged(std::vector<ParameterValue> values) {
  ParameterFile file;
  file.name = "particular";
  file.host = "nuc";
  file.values = std::move(values);
  return judge(component_factory<Particular>("particular"), file);
}

TEST(Judge, TellsWhatAComponentRefusesOfItsValues) {
  EXPECT_TRUE(judged({{"far", "2 m", "m.yaml:1"}}).ok());
  EXPECT_EQ(judged({{"far", "0.5 m", "m.yaml:1"}}).error(), "particular on nuc: near before far");
  EXPECT_THAT(judged({}).error(), HasSubstr("far"));
  EXPECT_THAT(judged({{"far", "2 m", "m.yaml:1"}, {"fra", "2 m", "m.yaml:2"}}).error(),
              HasSubstr("m.yaml:2"));
  EXPECT_THAT(judged({{"far", "2 kg", "m.yaml:1"}}).error(), HasSubstr("m.yaml:1"));
}

TEST(Contract, ComesBackFromItsYaml) {
  const auto contract = describe(component_factory<Sample>("sample"));
  ASSERT_TRUE(contract.ok());
  const std::string yaml = to_yaml(*contract);
  const auto back = contract_from_yaml(yaml, "sample.yaml");
  ASSERT_TRUE(back.ok()) << back.error() << "\n" << yaml;
  EXPECT_EQ(to_yaml(*back), yaml);
  ASSERT_EQ(back->parameters.size(), contract->parameters.size());
  for (std::size_t i = 0; i < contract->parameters.size(); ++i) {
    const auto &written = contract->parameters[i], &read = back->parameters[i];
    EXPECT_EQ(read.name, written.name);
    EXPECT_EQ(read.kind, written.kind) << written.name;
    EXPECT_EQ(read.unit, written.unit) << written.name;
    EXPECT_EQ(read.fallback, written.fallback) << written.name;
    EXPECT_EQ(read.range.low, written.range.low) << written.name;
    EXPECT_EQ(read.range.high, written.range.high) << written.name;
    EXPECT_EQ(read.required, written.required) << written.name;
    EXPECT_EQ(read.options, written.options) << written.name;
    EXPECT_EQ(read.fields.size(), written.fields.size()) << written.name;
    EXPECT_EQ(read.count_min, written.count_min) << written.name;
    EXPECT_EQ(read.text, written.text) << written.name;
  }
  EXPECT_EQ(back->inputs[0].max_age, 0.25);
  EXPECT_EQ(back->inputs[0].qos, contract->inputs[0].qos);
  EXPECT_EQ(back->idl_digest, contract->idl_digest);
}

TEST(Contract, NamesFileAndLineOfWhatIsWrong) {
  const auto error = [](const std::string& text) {
    return contract_from_yaml(text, "c.yaml").error();
  };
  const std::string head = "component: a\nversion: 1\nidl_digest: f\n";
  EXPECT_TRUE(contract_from_yaml(head, "c.yaml").ok());
  EXPECT_EQ(error(head + "colour: 1\n"), "unknown key colour (c.yaml:4)");
  EXPECT_EQ(error("version: 1\nidl_digest: f\n"), "component must be set (c.yaml:1)");
  EXPECT_EQ(error(head + "timers: 3\n"), "timers must be a list (c.yaml:4)");
  EXPECT_EQ(error(head + "timers:\n  - {name: x, period: soon}\n"),
            "period has the wrong type (c.yaml:5)");
  EXPECT_EQ(error(head + "parameters:\n  - {name: x, kind: colour, text: t}\n"),
            "unknown kind of parameter: colour (c.yaml:5)");
  EXPECT_THAT(error("[1"), HasSubstr("not YAML"));
  EXPECT_THAT(error(""), HasSubstr("expected a mapping"));
}

TEST(Describe, RefusesWrongDeclarations) {
  const auto error = [](std::function<void(Host&)> script) {
    const auto contract = describe({"sample", [&](Host& host) {
                                      script(host);
                                      return std::make_unique<Component>();
                                    }});
    return contract.ok() ? std::string() : contract.error();
  };
  EXPECT_EQ(error([](Host&) {}), "");
  EXPECT_THAT(error([](Host& host) {
                host.parameters().number("x", "m", {0, 1}, 2, "t");
              }),
              HasSubstr("x must be in [0, 1] m, got 2 m"));
  EXPECT_THAT(error([](Host& host) { host.input(topics::kScan, {std::chrono::seconds(1)}); }),
              HasSubstr("input scan has an age but does not say what its loss means"));
  EXPECT_THAT(error([](Host&) { throw std::runtime_error("no paper"); }),
              HasSubstr("cannot be constructed with its defaults: no paper"));
  EXPECT_EQ(error([](Host& host) { host.fault("no map with the defaults"); }), "");
}

}  // namespace
}  // namespace usher::runtime
