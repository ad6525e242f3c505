#include "runtime/dds/security.hpp"

#include <fastdds/rtps/transport/ChainingTransport.h>
#include <fastdds/rtps/transport/ChainingTransportDescriptor.h>
#include <fastdds/rtps/transport/TransportReceiverInterface.h>
#include <fastrtps/utils/IPLocator.h>
#include <sys/stat.h>
#include <unistd.h>
#include <fastdds/rtps/common/LocatorList.hpp>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <mutex>
#include <span>
#include <utility>

#include "runtime/dds/host_clock.hpp"
#include "runtime/dds/rtps_message.hpp"

namespace usher::runtime {
namespace {

namespace rtps = eprosima::fastrtps::rtps;
using eprosima::fastdds::rtps::ChainingTransport;
using eprosima::fastdds::rtps::ChainingTransportDescriptor;
using eprosima::fastdds::rtps::TransportDescriptorInterface;
using eprosima::fastdds::rtps::TransportInterface;
using eprosima::fastdds::rtps::TransportReceiverInterface;

/// Of a message that is not malformed.
SignedPresence::Prefix source_of(std::span<const std::uint8_t> message) {
  constexpr std::size_t kSourceAt = 8;
  SignedPresence::Prefix prefix{};
  std::copy_n(message.begin() + kSourceAt, prefix.size(), prefix.begin());
  return prefix;
}

class GuardedTransport final : public ChainingTransport {
 public:
  GuardedTransport(const ChainingTransportDescriptor& descriptor, GuardOptions options)
      : ChainingTransport(descriptor), options_(std::move(options)) {}

  TransportDescriptorInterface* get_configuration() override {
    return low_level_transport_->get_configuration();
  }

  bool send(rtps::SenderResource* below, const rtps::octet* bytes, std::uint32_t size,
            rtps::LocatorsIterator* begin, rtps::LocatorsIterator* end,
            const std::chrono::steady_clock::time_point& timeout) override {
    if (!options_.open->load()) return true;
    if (options_.only_signed && is_for_somebody_else({bytes, size})) return true;
    const MessageKind kind = classify({bytes, size});
    if (options_.announces_by_multicast &&
        (kind == MessageKind::kAnnouncement || kind == MessageKind::kFarewell))
      return send_beyond_loopback(below, {bytes, size}, begin, end, timeout);
    return below->send(bytes, size, begin, end, timeout);
  }
  void receive(TransportReceiverInterface* next, const rtps::octet* bytes, std::uint32_t size,
               const rtps::Locator_t& local, const rtps::Locator_t& remote) override {
    const MessageKind kind = classify({bytes, size});
    const bool welcome =
        options_.only_signed ? kind <= MessageKind::kHandshake : kind != MessageKind::kMalformed;
    if (!welcome) {
      if (kind != MessageKind::kFarewell) options_.refused(rtps::IPLocator::toIPv4string(remote));
      return;
    }
    if (options_.only_signed && options_.presence &&
        !options_.presence->hears(source_of({bytes, size}), kind == MessageKind::kSigned,
                                  MonotonicClock::read(CLOCK_MONOTONIC)))
      return;
    // Fast DDS 2.9.1 forgets how far the authentication of a participant got when its announcement
    // and its handshake arrive on two sockets at once; the two then never authenticate.
    std::unique_lock one_at_a_time(authentication_, std::defer_lock);
    if (options_.only_signed && kind != MessageKind::kSigned) one_at_a_time.lock();
    next->OnDataReceived(bytes, size, local, remote);
  }

 private:
  static bool send_beyond_loopback(rtps::SenderResource* below,
                                   std::span<const std::uint8_t> message,
                                   rtps::LocatorsIterator* begin, rtps::LocatorsIterator* end,
                                   const std::chrono::steady_clock::time_point& timeout) {
    rtps::LocatorList_t beyond;
    for (; *begin != *end; ++*begin) {
      if (!rtps::IPLocator::isLocal(**begin)) beyond.push_back(**begin);
    }
    if (beyond.empty()) return true;
    rtps::Locators first(beyond.begin());
    rtps::Locators last(beyond.end());
    return below->send(message.data(), static_cast<std::uint32_t>(message.size()), &first, &last,
                       timeout);
  }

  const GuardOptions options_;
  std::mutex authentication_;
};

class GuardedTransportDescriptor final : public ChainingTransportDescriptor {
 public:
  GuardedTransportDescriptor(std::shared_ptr<TransportDescriptorInterface> below,
                             GuardOptions options)
      : ChainingTransportDescriptor(std::move(below)), options_(std::move(options)) {}
  TransportInterface* create_transport() const override {
    return new GuardedTransport(*this, options_);  // NOLINT: the library takes it
  }

 private:
  const GuardOptions options_;
};

/// The library says nothing useful about a file that it cannot use.
Status judge_file(const std::string& path, bool is_private) {
  struct stat file {};
  if (::stat(path.c_str(), &file) != 0 || ::access(path.c_str(), R_OK) != 0) {
    return Error{"cannot read " + path + ": " + std::strerror(errno) +
                 " (`usher keys` makes the keys of a manifest)"};
  }
  if (is_private && (file.st_mode & (S_IRWXG | S_IRWXO)) != 0)
    return Error{"others may read the key " + path + ": its mode must be 0600"};
  return {};
}

}  // namespace

Status apply_identity(const std::string& folder,
                      eprosima::fastdds::dds::DomainParticipantQos& qos) {
  namespace fs = std::filesystem;
  std::error_code error;
  const fs::path own = fs::absolute(folder, error);
  const fs::path above = own.parent_path();
  const std::string authority = above / "ca.pem";
  const std::string governance = above / "governance.smime";
  const std::string certificate = own / "certificate.pem";
  const std::string key = own / "key.pem";
  const std::string permissions = own / "permissions.smime";
  for (const std::string& path : {authority, governance, certificate, key, permissions}) {
    if (auto status = judge_file(path, path == key); !status) return status;
  }
  const auto set = [&qos](const std::string& name, const std::string& value) {
    qos.properties().properties().emplace_back(name, value);
  };
  const std::string authentication = "dds.sec.auth.builtin.PKI-DH.";
  const std::string access = "dds.sec.access.builtin.Access-Permissions.";
  set("dds.sec.auth.plugin", "builtin.PKI-DH");
  set(authentication + "identity_ca", "file://" + authority);
  set(authentication + "identity_certificate", "file://" + certificate);
  set(authentication + "private_key", "file://" + key);
  set("dds.sec.access.plugin", "builtin.Access-Permissions");
  set(access + "permissions_ca", "file://" + authority);
  set(access + "governance", "file://" + governance);
  set(access + "permissions", "file://" + permissions);
  set("dds.sec.crypto.plugin", "builtin.AES-GCM-GMAC");
  return {};
}

std::shared_ptr<TransportDescriptorInterface> guarded_transport(
    std::shared_ptr<TransportDescriptorInterface> below, GuardOptions options) {
  return std::make_shared<GuardedTransportDescriptor>(std::move(below), std::move(options));
}

}  // namespace usher::runtime
