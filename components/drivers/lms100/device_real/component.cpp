#include "drivers/lms100/device_real/component.hpp"

#include "drivers/lms100/shell/model.hpp"

namespace usher::lms100 {

Session::Parameters Lms100Component::read_parameters(runtime::Parameters& parameters) {
  Session::Parameters p;
  p.dialect =
      parameters.choice("dialect", {"binary", "ascii"}, "binary", "CoLa-B or CoLa-A.") == "ascii"
          ? Dialect::kAscii
          : Dialect::kBinary;
  p.intensities = parameters.flag("intensities", p.intensities, "Ask for remission values too.");
  return p;
}

Lms100Component::Lms100Component(runtime::Host& host)
    : lost_(host.health().counter("scans: lost")),
      rejected_(host.health().counter("telegrams: rejected")),
      skipped_bytes_(host.health().counter("bytes: skipped")),
      damaged_(host.health().counter("telegrams: damaged")),
      line_(host, kModel, Session(read_parameters(host.parameters())),
            {.address = "tcp://192.168.0.1:2112",
             .text = "Where the scanner listens.",
             .count = [this](const Session& session) {
               lost_ = session.lost_scans();
               rejected_ = session.rejected();
               skipped_bytes_ = session.decoder().skipped_bytes();
               damaged_ = session.decoder().bad_checksums();
             }}) {}

}  // namespace usher::lms100
