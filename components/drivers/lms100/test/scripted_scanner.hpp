#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "drivers/lms100/core/cola.hpp"

namespace usher::lms100 {

using Bytes = std::vector<std::uint8_t>;

/// A scanner that answers as the documents and the recorded dialogue say.
class Scanner {
 public:
  explicit Scanner(Dialect dialect) : dialect_(dialect) {}

  bool refuse_login = false;
  int refuse_settings_with = 0;   ///< code of mLMPsetscancfg
  std::string refuse_with_error;  ///< name that is answered with sFA 3
  std::string mute;               ///< name that is not answered
  int polls_until_ready = 3;
  std::uint8_t device_status = 0;
  std::vector<std::string> heard;

  Bytes answer(const Bytes& sent) {
    Bytes out;
    decoder_.feed(sent);
    while (const auto telegram = decoder_.next()) {
      auto message = open(*telegram);
      if (!message) continue;
      heard.emplace_back(telegram->payload.begin(), telegram->payload.end());
      const std::string name(message->name);
      if (name == mute) continue;
      if (name == refuse_with_error) {
        append(out, error(3));
        continue;
      }
      Command reply(dialect_, answer_kind(message->kind), name);
      if (name == "SetAccessMode") {
        const bool right =
            message->fields.number(1) == 3 && message->fields.number(4) == 0xF4724744;
        reply.number(right && !refuse_login ? 1 : 0, 1);
      } else if (name == "mLMPsetscancfg") {
        reply.number(static_cast<std::uint32_t>(refuse_settings_with), 1);
        for (int i = 0; i < 5; ++i) reply.number(0, 4);
      } else if (name == "STlms") {
        reply.number(polls_until_ready-- > 0 ? 4 : 7, 2);
      } else if (name == "Run" || name == "LMDscandata") {
        reply.number(1, 1);
      } else if (name == "LMCstartmeas") {
        reply.number(0, 1);
      }
      append(out, reply.frame());
    }
    return out;
  }

  Bytes scan(std::uint16_t counter, std::uint32_t time_us) const {
    Command command(dialect_, "sSN", "LMDscandata");
    command.number(1, 2).number(1, 2).number(77, 4).number(0, 1).number(device_status, 1);
    command.number(counter, 2).number(counter, 2).number(time_us, 4).number(time_us + 3000, 4);
    for (int i = 0; i < 4; ++i) command.number(0, 1);
    command.number(0, 2).number(5000, 4).number(360, 4).number(0, 2).number(1, 2);
    Bytes frame = with_channel(command);
    return frame;
  }

 private:
  static std::string_view answer_kind(std::string_view kind) {
    return kind == "sMN" ? "sAN" : kind == "sWN" ? "sWA" : kind == "sEN" ? "sEA" : "sRA";
  }
  static void append(Bytes& out, const Bytes& more) {
    out.insert(out.end(), more.begin(), more.end());
  }
  Bytes error(std::uint8_t code) const {
    if (dialect_ == Dialect::kAscii) return {0x02, 's', 'F', 'A', ' ', std::uint8_t('0' + code), 3};
    Bytes payload{'s', 'F', 'A', 0, code};
    Bytes frame{2, 2, 2, 2, 0, 0, 0, static_cast<std::uint8_t>(payload.size())};
    std::uint8_t sum = 0;
    for (const std::uint8_t byte : payload) sum = static_cast<std::uint8_t>(sum ^ byte);
    append(frame, payload);
    frame.push_back(sum);
    return frame;
  }
  /// One channel of four values behind the header; the frame is rebuilt around its characters.
  Bytes with_channel(const Command& head) const {
    const Bytes framed = head.frame();
    const bool binary = dialect_ == Dialect::kBinary;
    Bytes payload(framed.begin() + (binary ? 8 : 1), framed.end() - 1);
    if (binary) {
      for (const char c : std::string("DIST1")) payload.push_back(static_cast<std::uint8_t>(c));
      append(payload, {0x3F, 0x80, 0, 0, 0, 0, 0, 0, 0xFF, 0xF9, 0x22, 0x30, 0x13, 0x88, 0, 4});
      append(payload, {3, 0xE8, 3, 0xE8, 0, 0, 7, 0xD0, 0, 0});
      Bytes frame{2,
                  2,
                  2,
                  2,
                  0,
                  0,
                  static_cast<std::uint8_t>(payload.size() >> 8),
                  static_cast<std::uint8_t>(payload.size())};
      std::uint8_t sum = 0;
      for (const std::uint8_t byte : payload) sum = static_cast<std::uint8_t>(sum ^ byte);
      append(frame, payload);
      frame.push_back(sum);
      return frame;
    }
    const std::string channel =
        " DIST1 3F800000 00000000 FFF92230 1388 4 3E8 3E8 0 7D0 0 0 0 0 0 0";
    payload.insert(payload.end(), channel.begin(), channel.end());
    Bytes frame{2};
    append(frame, payload);
    frame.push_back(3);
    return frame;
  }

  Dialect dialect_;
  Decoder decoder_;
};

}  // namespace usher::lms100
