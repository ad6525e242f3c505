#include "operations/security/permissions.hpp"

#include <tinyxml2.h>

#include <charconv>
#include <chrono>
#include <ctime>
#include <sstream>
#include <string_view>

#include "idl/topics.hpp"
#include "operations/security/authority.hpp"
#include "runtime/dds/signed_presence.hpp"

namespace usher::operations {

namespace {

constexpr const char* kHead = R"(<?xml version="1.0" encoding="UTF-8"?>
<dds xmlns:xsi="http://www.w3.org/2001/XMLSchema-instance")";

std::string wire_name(std::string_view topic) { return "rt/" + std::string(topic); }

/// Topics of the catalogue that `writer` may write besides the components.
std::set<std::string> catalogue_of(const std::string& writer) {
  std::set<std::string> topics;
  std::apply(
      [&](const auto&... topic) {
        const auto add = [&](const auto& t) {
          std::istringstream words{std::string(t.writers)};
          for (std::string word; words >> word;) {
            if (word == writer) topics.insert(wire_name(t.name));
          }
        };
        (add(topic), ...);
      },
      topics::kAll);
  return topics;
}

std::string date(std::chrono::system_clock::time_point time) {
  const std::time_t seconds = std::chrono::system_clock::to_time_t(time);
  std::tm parts{};
  gmtime_r(&seconds, &parts);
  char text[32];
  std::strftime(text, sizeof(text), "%Y-%m-%dT%H:%M:%S", &parts);
  return text;
}

void write_topics(std::ostream& out, const char* action, const std::set<std::string>& topics) {
  if (topics.empty()) return;
  out << "        <" << action << "><topics>\n";
  for (const auto& topic : topics) out << "          <topic>" << topic << "</topic>\n";
  out << "        </topics></" << action << ">\n";
}

std::set<std::string> read_topics(const tinyxml2::XMLElement* rule, const char* action) {
  std::set<std::string> topics;
  for (const auto* entry = rule->FirstChildElement(action); entry != nullptr;
       entry = entry->NextSiblingElement(action)) {
    const auto* list = entry->FirstChildElement("topics");
    if (list == nullptr) continue;
    for (const auto* topic = list->FirstChildElement("topic"); topic != nullptr;
         topic = topic->NextSiblingElement("topic")) {
      if (topic->GetText() != nullptr) topics.insert(topic->GetText());
    }
  }
  return topics;
}

/// The text of a chain of elements below `node`, empty where one is missing.
std::string text_at(const tinyxml2::XMLElement* node, std::initializer_list<const char*> chain) {
  for (const char* name : chain) {
    if (node != nullptr) node = node->FirstChildElement(name);
  }
  return node != nullptr && node->GetText() != nullptr ? node->GetText() : "";
}

}  // namespace

std::vector<Permissions> permissions_of(const Manifest& manifest, const Contracts& contracts) {
  std::vector<Permissions> all;
  for (const auto& component : manifest.components) {
    const auto contract = contracts.find(component.type);
    if (contract == contracts.end()) continue;
    Permissions own{.name = component.name, .domain = manifest.domain, .write = {}, .read = {}};
    own.write.insert(wire_name(topics::kHeartbeat.name));  // the host writes it for each component
    for (const auto& port : contract->second.outputs) own.write.insert(wire_name(port.topic));
    for (const auto& port : contract->second.inputs) own.read.insert(wire_name(port.topic));
    all.push_back(std::move(own));
  }
  all.push_back({kOperator, manifest.domain, catalogue_of(kOperator), {"*"}});
  all.push_back({kLauncher, manifest.domain, catalogue_of(kLauncher), {"*"}});
  if (!manifest.discovery_server.host.empty())
    all.push_back({kDiscoveryServer, manifest.domain, {}, {"*"}});
  return all;
}

std::string permissions_document(const Permissions& permissions, int days) {
  const auto now = std::chrono::system_clock::now();
  std::ostringstream out;
  out << kHead
      << " xsi:noNamespaceSchemaLocation=\"omg_shared_ca_permissions.xsd\">\n  <permissions>\n"
      << "    <grant name=\"" << permissions.name << "\">\n      <subject_name>"
      << subject_of(permissions.name) << "</subject_name>\n      <validity>\n        <not_before>"
      << date(now - std::chrono::hours(24)) << "</not_before>\n        <not_after>"
      << date(now + std::chrono::hours(24) * days) << "</not_after>\n      </validity>\n"
      << "      <allow_rule>\n        <domains><id>" << permissions.domain << "</id></domains>\n";
  auto write = permissions.write;
  auto read = permissions.read;
  write.insert(runtime::kAliveTopic);
  read.insert(runtime::kAliveTopic);
  write_topics(out, "publish", write);
  write_topics(out, "subscribe", read);
  out << "      </allow_rule>\n      <default>DENY</default>\n    </grant>\n  </permissions>\n"
      << "</dds>\n";
  return out.str();
}

Result<Permissions> read_permissions(const std::string& document) {
  tinyxml2::XMLDocument xml;
  if (xml.Parse(document.data(), document.size()) != tinyxml2::XML_SUCCESS)
    return Error{"these permissions are not XML: " + std::string(xml.ErrorStr())};
  const auto* root = xml.FirstChildElement("dds");
  const auto* list = root != nullptr ? root->FirstChildElement("permissions") : nullptr;
  const auto* grant = list != nullptr ? list->FirstChildElement("grant") : nullptr;
  const auto* rule = grant != nullptr ? grant->FirstChildElement("allow_rule") : nullptr;
  if (rule == nullptr) return Error{"these permissions grant nothing"};
  Permissions permissions;
  const std::string subject = text_at(grant, {"subject_name"});
  permissions.name = subject.substr(0, subject.find(','));
  if (permissions.name.starts_with("CN=")) permissions.name.erase(0, 3);
  const std::string domain = text_at(rule, {"domains", "id"});
  const char* end = domain.data() + domain.size();
  if (std::from_chars(domain.data(), end, permissions.domain).ptr != end || domain.empty())
    return Error{"these permissions name no DDS domain"};
  permissions.write = read_topics(rule, "publish");
  permissions.write.erase(runtime::kAliveTopic);
  permissions.read = read_topics(rule, "subscribe");
  permissions.read.erase(runtime::kAliveTopic);
  return permissions;
}

std::string governance_document(std::uint32_t domain) {
  std::ostringstream out;
  out << kHead
      << " xsi:noNamespaceSchemaLocation=\"omg_shared_ca_governance.xsd\">\n"
         "  <domain_access_rules>\n    <domain_rule>\n      <domains><id>"
      << domain << R"(</id></domains>
      <allow_unauthenticated_participants>false</allow_unauthenticated_participants>
      <enable_join_access_control>true</enable_join_access_control>
      <discovery_protection_kind>NONE</discovery_protection_kind>
      <liveliness_protection_kind>NONE</liveliness_protection_kind>
      <rtps_protection_kind>SIGN</rtps_protection_kind>
      <topic_access_rules>
        <topic_rule>
          <topic_expression>*</topic_expression>
          <enable_discovery_protection>false</enable_discovery_protection>
          <enable_liveliness_protection>false</enable_liveliness_protection>
          <enable_read_access_control>true</enable_read_access_control>
          <enable_write_access_control>true</enable_write_access_control>
          <metadata_protection_kind>NONE</metadata_protection_kind>
          <data_protection_kind>NONE</data_protection_kind>
        </topic_rule>
      </topic_access_rules>
    </domain_rule>
  </domain_access_rules>
</dds>
)";
  return out.str();
}

}  // namespace usher::operations
