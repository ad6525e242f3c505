#include <arpa/inet.h>
#include <fcntl.h>
#include <gmock/gmock.h>
#include <netinet/in.h>
#include <poll.h>
#include <pty.h>
#include <signal.h>
#include <sys/socket.h>
#include <unistd.h>

#include <condition_variable>
#include <limits>
#include <mutex>

#include "runtime/dds/streams.hpp"
#include "runtime/guard/port.hpp"
#include "support/process.hpp"

namespace usher::runtime {
namespace {

using namespace std::chrono_literals;
using testing::HasSubstr;

/// What a stream reported, and a way to wait for it.
class Log {
 public:
  StreamSink sink() {
    return {[this] { add([this] { ++opened; }); },
            [this](std::span<const std::uint8_t> bytes) {
              bool accepted = false;
              add([&] {
                accepted = refusals == 0;
                if (accepted) received.append(bytes.begin(), bytes.end());
                if (!accepted) --refusals;
              });
              return accepted;
            },
            [this](const std::string& reason) { add([&] { closed.push_back(reason); }); }};
  }
  template <class Condition>
  bool wait(Condition condition) {
    std::unique_lock lock(mutex_);
    return changed_.wait_for(lock, 10s, condition);
  }

  int opened = 0;
  int refusals = 0;
  std::string received;
  std::vector<std::string> closed;

 private:
  template <class Change>
  void add(const Change& change) {
    const std::scoped_lock lock(mutex_);
    change();
    changed_.notify_all();
  }
  std::mutex mutex_;
  std::condition_variable changed_;
};

Bytes bytes(std::string_view text) { return {text.begin(), text.end()}; }

/// A TCP server on a free port of the loopback.
class Server {
 public:
  Server() : listener_(::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0)) { bind_to(0); }
  ~Server() {
    drop();
    stop();
  }
  std::string uri() const { return "tcp://127.0.0.1:" + std::to_string(port_); }
  void accept() {
    pollfd entry{listener_, POLLIN, 0};
    if (::poll(&entry, 1, 10000) == 1)
      connection_ = ::accept4(listener_, nullptr, nullptr, SOCK_CLOEXEC);
    ASSERT_GE(connection_, 0);
  }
  void send(std::string_view text) const {
    ASSERT_EQ(::send(connection_, text.data(), text.size(), MSG_NOSIGNAL), ssize_t(text.size()));
  }
  std::string read(std::size_t size) const {
    std::string text(size, '\0');
    const ssize_t count = ::recv(connection_, text.data(), size, MSG_WAITALL);
    text.resize(static_cast<std::size_t>(std::max<ssize_t>(count, 0)));
    return text;
  }
  void drop() {
    if (connection_ >= 0) ::close(connection_);
    connection_ = -1;
  }
  /// Takes the next one who calls, and a new guard's first words.
  void accept_guard() {
    drop();
    accept();
    EXPECT_EQ(read(12), "[stop][stop]");
  }
  /// It says nothing and stays.
  bool stays(std::chrono::milliseconds so_long) const {
    pollfd entry{connection_, POLLIN, 0};
    return ::poll(&entry, 1, static_cast<int>(so_long.count())) == 0;
  }
  void stop() {
    if (listener_ >= 0) ::close(listener_);
    listener_ = -1;
  }

 private:
  void bind_to(std::uint16_t port) {
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_port = htons(port);
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    socklen_t size = sizeof(address);
    const int yes = 1;
    ::setsockopt(listener_, SOL_SOCKET, SO_REUSEADDR, &yes, sizeof(yes));
    ASSERT_EQ(::bind(listener_, reinterpret_cast<sockaddr*>(&address), size), 0);
    ASSERT_EQ(::listen(listener_, 1), 0);
    ::getsockname(listener_, reinterpret_cast<sockaddr*>(&address), &size);
    port_ = ntohs(address.sin_port);
  }
  int listener_;
  int connection_ = -1;
  std::uint16_t port_ = 0;
};

TEST(StreamAddress, ReadsEachKind) {
  struct Case {
    const char* uri;
    StreamAddress::Kind kind;
    const char* target;
    int number;
  };
  using enum StreamAddress::Kind;
  for (const Case& test :
       {Case{"tcp://192.168.1.2:2112", kTcp, "192.168.1.2", 2112},
        Case{"listen://localhost:7400", kListen, "127.0.0.1", 7400},
        Case{"serial:///dev/ttyUSB0?baud=115200", kSerial, "/dev/ttyUSB0", 115200},
        Case{"device:///dev/input/js0", kDevice, "/dev/input/js0", 0}}) {
    const auto address = StreamAddress::parse(test.uri);
    ASSERT_TRUE(address.ok()) << test.uri;
    EXPECT_EQ(address->kind, test.kind) << test.uri;
    EXPECT_EQ(address->target, test.target);
    EXPECT_EQ(address->number, test.number);
  }
}

TEST(StreamAddress, RefusesEverythingElse) {
  for (const char* uri :
       {"", "tcp://", "tcp://host.local:1", "tcp://1.2.3.4", "tcp://1.2.3.4:0",
        "tcp://1.2.3.4:65536", "tcp://1.2.3.4:1x", "tcp://:5", "serial:///dev/x",
        "serial:///dev/x?baud=12345", "serial://?baud=9600", "udp://1.2.3.4:5", "/dev/ttyUSB0",
        "listen://0.0.0.0", "device://", "device://js0", "serial://dev/x?baud=9600"}) {
    EXPECT_FALSE(StreamAddress::parse(uri).ok()) << uri;
  }
}

TEST(Streams, MoveBytesBothWaysOverTcp) {
  Server server;
  Log log;
  Streams streams;
  Stream& stream = streams.open(server.uri(), log.sink());
  server.accept();
  ASSERT_TRUE(log.wait([&] { return log.opened == 1; }));
  EXPECT_TRUE(stream.open());
  EXPECT_TRUE(stream.write(bytes("sRN LMDscandata")));
  EXPECT_EQ(server.read(15), "sRN LMDscandata");
  server.send("answer");
  EXPECT_TRUE(log.wait([&] { return log.received == "answer"; }));
}

TEST(Streams, OpenAnewAfterTheOtherSideHasGone) {
  Server server;
  Log log;
  Streams streams;
  Stream& stream = streams.open(server.uri(), log.sink());
  server.accept();
  ASSERT_TRUE(log.wait([&] { return log.opened == 1; }));
  server.drop();
  ASSERT_TRUE(log.wait([&] { return log.closed.size() == 1; }));
  EXPECT_THAT(log.closed[0], HasSubstr("closed by the other side"));
  EXPECT_FALSE(stream.write(bytes("x")));
  server.accept();
  EXPECT_TRUE(log.wait([&] { return log.opened == 2; }));
  EXPECT_TRUE(stream.write(bytes("y")));
  EXPECT_EQ(server.read(1), "y");
}

TEST(Streams, ReportEachFailureToOpenAndTryAgain) {
  Server server;
  const std::string uri = server.uri();
  server.stop();
  Log log;
  Streams streams;
  const auto begin = std::chrono::steady_clock::now();
  streams.open(uri, log.sink());
  ASSERT_TRUE(log.wait([&] { return log.closed.size() == 2; }));
  EXPECT_GE(std::chrono::steady_clock::now() - begin, 990ms);
  EXPECT_THAT(log.closed[0], HasSubstr(uri));
  EXPECT_THAT(log.closed[0], HasSubstr("refused"));
  EXPECT_EQ(log.opened, 0);
}

TEST(Streams, ReportAWrongAddressOnce) {
  Log log;
  Streams streams;
  Stream& stream = streams.open("tcp://nowhere", log.sink());
  ASSERT_TRUE(log.wait([&] { return !log.closed.empty(); }));
  EXPECT_THAT(log.closed[0], HasSubstr("tcp://nowhere"));
  stream.reopen({});
  EXPECT_FALSE(stream.open());
  EXPECT_FALSE(stream.write(bytes("x")));
}

TEST(Streams, OfferRefusedBytesAgain) {
  Server server;
  Log log;
  log.refusals = 3;
  Streams streams;
  streams.open(server.uri(), log.sink());
  server.accept();
  server.send("important");
  EXPECT_TRUE(log.wait([&] { return log.received == "important"; }));
  EXPECT_EQ(log.refusals, 0);
}

TEST(Streams, QueueAtMost64Kilobytes) {
  Server server;
  Log log;
  Streams streams;
  Stream& stream = streams.open(server.uri(), log.sink());
  server.accept();
  ASSERT_TRUE(log.wait([&] { return log.opened == 1; }));
  // Nobody reads: the kernel's buffers fill, then the queue, then write() refuses. Nothing of what
  // it took is lost.
  std::size_t taken = 0;
  const Bytes block(32768, 'b');
  while (stream.write(block) && taken < (64U << 20)) taken += block.size();
  ASSERT_LT(taken, 64U << 20);
  EXPECT_EQ(server.read(taken).size(), taken);
  EXPECT_FALSE(stream.write(Bytes(65537)));
}

TEST(Streams, ReopenWhenTheComponentAsks) {
  Server server;
  Log log;
  Streams streams;
  Stream& stream = streams.open(server.uri(), log.sink());
  server.accept();
  ASSERT_TRUE(log.wait([&] { return log.opened == 1; }));
  stream.reopen(10ms);
  ASSERT_TRUE(log.wait([&] { return log.closed.size() == 1; }));
  EXPECT_THAT(log.closed[0], HasSubstr("reopened by the component"));
  server.drop();
  server.accept();
  EXPECT_TRUE(log.wait([&] { return log.opened == 2; }));
}

TEST(Streams, SpeakRawOnASerialLine) {
  int master = -1;
  int slave = -1;
  std::array<char, 128> name{};
  ASSERT_EQ(::openpty(&master, &slave, name.data(), nullptr, nullptr), 0);
  ::close(slave);
  Log log;
  {
    Streams streams;
    Stream& stream =
        streams.open("serial://" + std::string(name.data()) + "?baud=115200", log.sink());
    ASSERT_TRUE(log.wait([&] { return log.opened == 1; }));
    // Bytes that a terminal would swallow or translate.
    EXPECT_TRUE(stream.write(bytes("\x03\r\n\x11")));
    std::array<char, 4> read{};
    ASSERT_EQ(::read(master, read.data(), read.size()), 4);
    EXPECT_EQ(std::string_view(read.data(), 4), "\x03\r\n\x11");
    ASSERT_EQ(::write(master, "\x04\r\x7f", 3), 3);
    EXPECT_TRUE(log.wait([&] { return log.received == "\x04\r\x7f"; }));
  }
  ::close(master);
}

TEST(Streams, ReportASerialLineThatIsNotThereOrUnplugged) {
  Log absent;
  Log unplugged;
  int master = -1;
  int slave = -1;
  std::array<char, 128> name{};
  ASSERT_EQ(::openpty(&master, &slave, name.data(), nullptr, nullptr), 0);
  ::close(slave);
  Streams streams;
  streams.open("serial:///dev/no-such-device?baud=9600", absent.sink());
  streams.open("serial://" + std::string(name.data()) + "?baud=9600", unplugged.sink());
  ASSERT_TRUE(absent.wait([&] { return !absent.closed.empty(); }));
  EXPECT_THAT(absent.closed[0], HasSubstr("/dev/no-such-device"));
  ASSERT_TRUE(unplugged.wait([&] { return unplugged.opened == 1; }));
  ::close(master);
  EXPECT_TRUE(unplugged.wait([&] { return !unplugged.closed.empty(); }));
}

TEST(Streams, ListenForOneCallerAfterTheOther) {
  Server free_port;
  const std::string where = free_port.uri().substr(6);
  free_port.stop();
  Log here;
  Log there;
  Streams streams;
  Stream& stream = streams.open("listen://" + where, here.sink());
  {
    Streams callers;
    Stream& caller = callers.open("tcp://" + where, there.sink());
    ASSERT_TRUE(here.wait([&] { return here.opened == 1; }));
    ASSERT_TRUE(there.wait([&] { return there.opened == 1; }));
    EXPECT_TRUE(caller.write(bytes("hello")));
    EXPECT_TRUE(here.wait([&] { return here.received == "hello"; }));
    EXPECT_TRUE(stream.write(bytes("welcome")));
    EXPECT_TRUE(there.wait([&] { return there.received == "welcome"; }));
  }
  ASSERT_TRUE(here.wait([&] { return here.closed.size() == 1; }));
  Streams callers;
  callers.open("tcp://" + where, there.sink());
  EXPECT_TRUE(here.wait([&] { return here.opened == 2; }));
}

/// Fills the line until it takes no more, then 1000 velocities of which the newest is "now.", and
/// reads what the device gets once the line moves again: how many velocities after the filling.
std::string after_a_blocked_line(const StreamSink& sink, Log& log) {
  int master = -1;
  int slave = -1;
  std::array<char, 128> name{};
  EXPECT_EQ(::openpty(&master, &slave, name.data(), nullptr, nullptr), 0);
  ::close(slave);
  std::string heard;
  {
    Streams streams;
    Stream& stream = streams.open("serial://" + std::string(name.data()) + "?baud=460800", sink);
    EXPECT_TRUE(log.wait([&] { return log.opened == 1; }));
    EXPECT_TRUE(stream.write(bytes(std::string(40000, '#'))));
    for (int i = 0; i < 1000; ++i) EXPECT_TRUE(stream.write_latest(bytes("old.")));
    EXPECT_TRUE(stream.write_latest(bytes("now.")));
    pollfd entry{master, POLLIN, 0};
    std::array<char, 4096> buffer{};
    while (!heard.ends_with("now.") && ::poll(&entry, 1, 10000) == 1) {
      const ssize_t count = ::read(master, buffer.data(), buffer.size());
      if (count <= 0) break;
      heard.append(buffer.data(), static_cast<std::size_t>(count));
    }
  }
  ::close(master);
  return heard.substr(std::min<std::size_t>(heard.find_last_of('#') + 1, heard.size()));
}

TEST(Streams, TheNewestCommandReplacesWhatABlockedLineDidNotTake) {
  Log log;
  EXPECT_EQ(after_a_blocked_line(log.sink(), log), "now.");
}

/// A sink whose port belongs to a guard process.
StreamSink guarded(Log& log, std::chrono::milliseconds silence) {
  StreamSink sink = log.sink();
  sink.guard = {bytes("[stop]"), silence};
  return sink;
}

/// A stream whose guard has the port, and has greeted it.
Stream& open_guarded(Streams& streams, Server& server, Log& log,
                     std::chrono::milliseconds silence) {
  Stream& stream = streams.open(server.uri(), guarded(log, silence));
  server.accept_guard();
  EXPECT_TRUE(log.wait([&] { return log.opened == 1; }));
  return stream;
}

TEST(GuardedStreams, PassBytesBothWays) {
  Server server;
  Log log;
  Streams streams;
  Stream& stream = open_guarded(streams, server, log, 10s);
  EXPECT_TRUE(stream.write(bytes("drive")));
  EXPECT_EQ(server.read(5), "drive");
  server.send("moving");
  EXPECT_TRUE(log.wait([&] { return log.received == "moving"; }));
}

TEST(GuardedStreams, TheNewestCommandReplacesWhatABlockedLineDidNotTake) {
  Log log;
  // What the guard had begun to hand on goes first.
  const std::string heard = after_a_blocked_line(guarded(log, 10s), log);
  EXPECT_TRUE(heard == "now." || heard == "old.now.") << heard;
}

TEST(GuardedStreams, AreSafeWhenTheDriverIsGone) {
  Server server;
  Log log;
  {
    Streams streams;
    Stream& stream = open_guarded(streams, server, log, 10s);
    EXPECT_TRUE(stream.write(bytes("drive")));
    EXPECT_EQ(server.read(5), "drive");
  }
  EXPECT_EQ(server.read(1000), "[stop][stop][stop]") << "and the guard has ended";
}

TEST(GuardedStreams, AreSafeWhileTheDriverIsSilent) {
  Server server;
  Log log;
  Streams streams;
  Stream& stream = open_guarded(streams, server, log, 50ms);
  EXPECT_TRUE(stream.write(bytes("drive")));
  EXPECT_EQ(server.read(29), "drive[stop][stop][stop][stop]");
  EXPECT_TRUE(stream.write(bytes("drive")));
  std::string heard;
  while (heard.find("drive") == std::string::npos) heard += server.read(1);
  EXPECT_EQ(heard.find_first_not_of("[stop]drive"), std::string::npos) << heard;
}

TEST(GuardedStreams, SayTheLastWillOfASilentDriverBeforeWhatIsSafe) {
  Server server;
  Log log;
  Streams streams;
  Stream& stream = open_guarded(streams, server, log, 300ms);
  EXPECT_TRUE(stream.write(bytes("drive")));
  stream.last_will(bytes("[none]"), 0ms);
  stream.last_will(bytes("[turn]"), 290ms);  // three times in a silence of 300 ms
  EXPECT_EQ(server.read(29), "drive[turn][turn][turn][stop]");
}

/// A driver drives, leaves a will of so long, and ends.
void drive_and_end(Server& server, std::chrono::milliseconds lasts) {
  Log log;
  Streams streams;
  Stream& stream = open_guarded(streams, server, log, 300ms);
  EXPECT_TRUE(stream.write(bytes("drive")));
  EXPECT_EQ(server.read(5), "drive");
  stream.last_will(bytes("[turn]"), lasts);
}

TEST(GuardedStreams, SayTheLastWillOfADriverThatEnded) {
  Server server;
  drive_and_end(server, 290ms);
  EXPECT_THAT(server.read(1000),
              testing::MatchesRegex("(\\[turn\\])+\\[stop\\]\\[stop\\]\\[stop\\]"));
}

TEST(GuardedStreams, TheNextDriverHasThePortWithoutWaitingForAWill) {
  Server server;
  drive_and_end(server, 1s);
  EXPECT_EQ(server.read(6), "[turn]");
  Log log;
  Streams streams;
  streams.open(server.uri(), guarded(log, 10s));
  EXPECT_THAT(server.read(1000), testing::EndsWith("[stop][stop][stop]"));
  server.accept_guard();
  EXPECT_TRUE(log.wait([&] { return log.opened == 1; }));
  EXPECT_THAT(log.closed, testing::IsEmpty()) << "at the first go";
}

TEST(GuardedStreams, OneDriverHasAPort) {
  Server server;
  Log log, second;
  Streams streams, others;
  Stream& stream = open_guarded(streams, server, log, 10s);
  others.open(server.uri(), guarded(second, 10s));
  ASSERT_TRUE(second.wait([&] { return !second.closed.empty(); }));
  EXPECT_THAT(second.closed[0], HasSubstr("another driver's guard has it"));
  EXPECT_TRUE(stream.write(bytes("drive")));
  EXPECT_EQ(server.read(5), "drive");
}

TEST(GuardedStreams, AReopeningDriverHasNoWill) {
  Server server;
  Log log;
  Streams streams;
  Stream& stream = open_guarded(streams, server, log, 10s);
  EXPECT_TRUE(stream.write(bytes("drive")));
  stream.last_will(bytes("[turn]"), 1s);
  EXPECT_EQ(server.read(5), "drive");
  stream.reopen({});
  EXPECT_EQ(server.read(1000), "[stop][stop][stop]");
  server.accept_guard();
}

TEST(GuardedStreams, AReopeningDriverThatDidNotReadAllHasNoWill) {
  Server server;
  Log log;
  log.refusals = std::numeric_limits<int>::max();
  Streams streams;
  Stream& stream = open_guarded(streams, server, log, 10s);
  EXPECT_TRUE(stream.write(bytes("drive")));
  stream.last_will(bytes("[turn]"), 1s);
  EXPECT_EQ(server.read(5), "drive");
  server.send("moving");
  EXPECT_TRUE(server.stays(100ms)) << "its guard shows life, which waits unread";
  stream.reopen({});
  EXPECT_EQ(server.read(1000), "[stop][stop][stop]");
  server.accept_guard();
}

TEST(GuardedStreams, ReplaceAGuardThatHangs) {
  Server server;
  Log log;
  Streams streams;
  Stream& stream = open_guarded(streams, server, log, 10s);
  const pid_t guard = test::guard_of(::getpid());
  ASSERT_GT(guard, 0);
  const auto opened = log.opened;  // on a busy machine the first guard may have been replaced
  ::kill(guard, SIGSTOP);
  ASSERT_TRUE(log.wait([&] { return !log.closed.empty(); }));
  EXPECT_THAT(log.closed[0], HasSubstr("its guard hung and was killed"));
  server.accept_guard();
  ASSERT_TRUE(log.wait([&] { return log.opened > opened; }));
  EXPECT_EQ(::kill(guard, 0), -1) << "one owner of the port";
  EXPECT_TRUE(stream.write(bytes("drive")));
  EXPECT_EQ(server.read(5), "drive");
}

TEST(GuardedStreams, ReplaceAGuardThatIsKilled) {
  Server server;
  Log log;
  Streams streams;
  Stream& stream = open_guarded(streams, server, log, 10s);
  const pid_t guard = test::guard_of(::getpid());
  ASSERT_GT(guard, 0);
  const auto opened = log.opened;  // on a busy machine the first guard may have been replaced
  ::kill(guard, SIGKILL);
  server.accept_guard();
  ASSERT_TRUE(log.wait([&] { return log.opened > opened; }));
  EXPECT_TRUE(stream.write(bytes("drive")));
  EXPECT_EQ(server.read(5), "drive");
}

TEST(GuardedStreams, EndAGuardThatHangsWhenTheyReopen) {
  Server server;
  Log log;
  Streams streams;
  Stream& stream = open_guarded(streams, server, log, 10s);
  const pid_t guard = test::guard_of(::getpid());
  ASSERT_GT(guard, 0);
  const auto opened = log.opened;  // on a busy machine the first guard may have been replaced
  ::kill(guard, SIGSTOP);
  stream.reopen({});
  server.accept_guard();
  ASSERT_TRUE(log.wait([&] { return log.opened > opened; }));
  EXPECT_TRUE(log.wait([&] { return ::kill(guard, 0) == -1; })) << "one owner of the port";
}

TEST(GuardedStreams, KeepAGuardWhenNobodySaysAnythingOrTheDriverDoesNotRead) {
  Server server;
  Log log;
  log.refusals = 100;
  Streams streams;
  Stream& stream = streams.open(server.uri(), guarded(log, 10s));
  server.accept_guard();
  EXPECT_TRUE(server.stays(1200ms));
  server.send("moving");
  ASSERT_TRUE(log.wait([&] { return log.received == "moving"; }));
  EXPECT_TRUE(stream.open());
  EXPECT_THAT(log.closed, testing::IsEmpty());
}

TEST(GuardedStreams, SayWhyThePortCannotBeOpened) {
  Server server;
  const std::string uri = server.uri();
  server.stop();
  Log log;
  Streams streams;
  streams.open(uri, guarded(log, 50ms));
  ASSERT_TRUE(log.wait([&] { return !log.closed.empty(); }));
  EXPECT_THAT(log.closed[0], HasSubstr("cannot open " + uri + ": Connection refused"));
  EXPECT_EQ(log.opened, 0);
}

TEST(GuardedStreams, OpenAnewAfterThePortHasFailed) {
  Server server;
  Log log;
  Streams streams;
  streams.open(server.uri(), guarded(log, 50ms));
  server.accept_guard();
  ASSERT_TRUE(log.wait([&] { return log.opened == 1; }));
  server.drop();
  ASSERT_TRUE(log.wait([&] { return log.closed.size() == 1; }));
  server.accept_guard();
  EXPECT_TRUE(log.wait([&] { return log.opened == 2; }));
}

}  // namespace
}  // namespace usher::runtime
