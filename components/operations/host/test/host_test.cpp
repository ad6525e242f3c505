#include <gmock/gmock.h>
#include <unistd.h>

#include <chrono>
#include <thread>

#include "foundation/kinematics/roll_out.hpp"
#include "operations/host/doctor.hpp"
#include "operations/host/service.hpp"
#include "support/folder.hpp"
#include "support/process.hpp"
#include "support/service_manager.hpp"

namespace usher::operations {
namespace {

using testing::Contains;
using testing::HasSubstr;
using testing::Not;

Manifest manifest() {
  Manifest made;
  made.name = "marvin";
  return made;
}

TEST(ServiceUnit, RestartsAndIsWatched) {
  const auto unit = service_unit(manifest(), {.program = "/usr/bin/usher",
                                              .manifest = "/etc/usher/my robot 100%.yaml",
                                              .host = "nuc",
                                              .keys = "/etc/usher/keys",
                                              .user = "usher"});
  EXPECT_EQ(unit.name, "usher-nuc.service");
  EXPECT_THAT(unit.text,
              HasSubstr("ExecStart=\"/usr/bin/usher\" launch \"/etc/usher/my robot 100%%.yaml\" "
                        "--host \"nuc\" --run-directory \"/var/lib/usher/nuc\" "
                        "--keys \"/etc/usher/keys\"\n"));
  for (const auto* line : {"Type=notify\n", "StateDirectory=usher\n", "Restart=always\n",
                           "WatchdogSec=5\n", "KillMode=control-group\n", "User=usher\n",
                           "WantedBy=multi-user.target\n", "LimitNICE=31\n", "LimitRTPRIO=10\n"})
    EXPECT_THAT(unit.text, HasSubstr(line));
}

TEST(ServiceUnit, OfAHungLauncherEndsTheBasesGuardByNoSignalBeforeTheBaseStands) {
  const auto unit = service_unit(
      manifest(),
      {.program = "/bin/true", .manifest = "/m.yaml", .host = "nuc", .keys = "", .user = ""});
  // With this KillMode the watchdog's signal goes to all processes, SIGKILL to what is left of
  // them; a guard ignores SIGTERM.
  EXPECT_THAT(unit.text, HasSubstr("\nKillMode=control-group\n"));
  EXPECT_THAT(unit.text, HasSubstr("\nWatchdogSignal=SIGTERM\n"));
  EXPECT_THAT(unit.text, Not(HasSubstr("SIGKILL")));
  const std::string key = "\nTimeoutAbortSec=";
  const auto at = unit.text.find(key);
  ASSERT_NE(at, std::string::npos) << "TimeoutStopSec= would count: the robot waits for nothing";
  const std::chrono::duration<double> patience(std::stod(unit.text.substr(at + key.size())));
  constexpr std::chrono::duration<double> kSilence(0.15);  // of a hung driver, to its guard
  EXPECT_GT(patience, kSilence + kinematics::RollOut::longest(10.0));
}

TEST(ServiceUnit, IsAcceptedBySystemd) {
  if (::access("/usr/bin/systemd-analyze", X_OK) != 0) GTEST_SKIP() << "no systemd-analyze";
  const test::Folder folder;
  const auto unit = service_unit(manifest(), {.program = "/bin/true",
                                              .manifest = "/etc/usher/my robot.yaml",
                                              .host = "nuc",
                                              .keys = "",
                                              .user = ""});
  const auto path = folder.file(unit.name, unit.text);
  test::Process verify({"/usr/bin/systemd-analyze", "verify", "--man=no", path});
  EXPECT_EQ(verify.wait(), 0) << verify.errors();
  EXPECT_THAT(verify.errors(), Not(HasSubstr(unit.name))) << "not even a warning";
}

constexpr std::chrono::milliseconds kWatchdog(60);

TEST(Notify, TellsTheWatchdogOnlyWhileHealthy) {
  const test::ServiceManager manager(kWatchdog);
  ServiceNotifier service;
  EXPECT_EQ(::getenv("NOTIFY_SOCKET"), nullptr) << "components must not speak for the launcher";
  service.ready();
  service.alive(true, "3 of 3 processes run");
  EXPECT_THAT(manager.heard(),
              testing::ElementsAre("READY=1", "STATUS=3 of 3 processes run", "WATCHDOG=1"));
  service.alive(true, "3 of 3 processes run");
  EXPECT_TRUE(manager.heard().empty()) << "not more often than it must";
  std::this_thread::sleep_for(std::chrono::milliseconds(25));
  service.alive(false, "2 of 3 processes run: amcl is given up");
  EXPECT_THAT(manager.heard(),
              testing::ElementsAre("STATUS=2 of 3 processes run: amcl is given up"));
  service.alive(true, "2 of 3 processes run: amcl is given up");
  EXPECT_THAT(manager.heard(), testing::ElementsAre("WATCHDOG=1"));
  service.stopping();
  EXPECT_THAT(manager.heard(), testing::ElementsAre("STOPPING=1"));
}

TEST(Notify, IsSilentWithoutAServiceManager) {
  const test::ServiceManager manager(kWatchdog);
  ::unsetenv("NOTIFY_SOCKET");
  ServiceNotifier service;
  service.ready();
  service.alive(true, "well");
  EXPECT_TRUE(manager.heard().empty());
}

TEST(Doctor, ExaminesThisMachine) {
  const test::Folder folder;
  const auto found = examine_host(folder.path() + "/run/usher");
  std::vector<std::string> subjects;
  for (const auto& diagnosis : found) {
    subjects.push_back(diagnosis.subject);
    EXPECT_FALSE(diagnosis.found.empty()) << diagnosis.subject;
    EXPECT_EQ(diagnosis.remedy.empty(), diagnosis.verdict == Diagnosis::Verdict::kGood)
        << diagnosis.subject;
  }
  for (const auto* subject : {"receive buffer", "send buffer", "sysctl file", "clock",
                              "shared memory", "run directory", "precedence", "multicast on lo"})
    EXPECT_THAT(subjects, Contains(subject));
}

TEST(Doctor, FindsWhatIsWrongWithAFolderOfKeys) {
  const test::Folder folder;
  const auto none = examine_keys(folder.path());
  ASSERT_EQ(none.size(), 1U);
  EXPECT_EQ(none[0].verdict, Diagnosis::Verdict::kBad);
}

TEST(Doctor, WantsWhatTheShippedFileSets) {
  EXPECT_EQ(test::content_of(std::string(USHER_SOURCE_DIR) + "/deploy/sysctl.d/60-usher.conf"),
            sysctl_file());
}

}  // namespace
}  // namespace usher::operations
