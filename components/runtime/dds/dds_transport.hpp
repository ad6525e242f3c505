#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "foundation/result/result.hpp"
#include "runtime/dds/host_clock.hpp"
#include "runtime/engine/transport.hpp"

namespace usher::runtime {

/// Carries the samples of one component over Fast DDS: one participant with the component's name,
/// and a second one in the domain of the fleet, "robot/component", once it has a port there.
/// Received samples are decoded and delivered in the middleware's threads. A topic that the
/// catalogue calls "scan" is "rt/scan" on the wire.
class DdsTransport final : public Transport {
 public:
  struct Fleet {
    std::string robot;  ///< empty = belongs to none
    std::uint32_t domain = 0;
    std::vector<std::string> peers;  ///< of the other robots, besides multicast
  };
  struct Options {
    std::string name;
    std::string host;
    std::uint32_t domain = 0;
    std::vector<std::string> peers;  ///< numeric IPv4 addresses besides multicast
    std::string discovery_server;    ///< "10.0.0.1:11811"; empty = everybody announces to everybody
    std::string identity;            ///< folder of `usher keys`; empty = without security
    Fleet fleet{};
  };
  /// Fails when a domain is not 0..232, a peer is no address, the machine has no network at all, or
  /// a fleet comes together with security: nothing on the fleet's domain is signed.
  static Result<std::unique_ptr<DdsTransport>> create(const Options& options,
                                                      const MonotonicClock& clock);
  ~DdsTransport() override;

  Reader& open_reader(const InputDeclaration& declaration, Deliver deliver) override;
  Writer& open_writer(const OutputDeclaration& declaration) override;
  void watch_writers(const std::string& topic,
                     std::function<void(const WriterInfo&)> event) override;

  /// After the last sample of `topic`, which says why a component ended: writes it three more times
  /// within 0.15 s, for nobody acknowledges heartbeats. Not in the first half second of the
  /// participant's life: a component that ends right after its start has not been discovered yet.
  void farewell(const std::string& topic);

 private:
  class Implementation;
  explicit DdsTransport(std::unique_ptr<Implementation> implementation);
  std::unique_ptr<Implementation> implementation_;
};

}  // namespace usher::runtime
