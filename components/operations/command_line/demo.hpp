#pragma once

#include <chrono>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

#include "foundation/result/result.hpp"
#include "operations/experiments/run_record.hpp"
#include "operations/manifest/resolve.hpp"
#include "operations/results/result_sheet.hpp"
#include "runtime/dds/observer.hpp"

namespace usher::operations {

/// What a demo shows and promises; the run around it (demo_command.cpp) is the same for all. What
/// takes the record is called with its mutex locked.
class Demo {
 public:
  struct Text {
    std::string name;      ///< of the result sheet
    std::string manifest;  ///< in deploy/
    std::string title;     ///< what is seen
    std::string kept;      ///< the verdict
    std::string broken;    ///< the other one
  };
  virtual ~Demo() = default;
  virtual const Text& text() const = 0;
  virtual std::chrono::seconds longest() const = 0;
  virtual std::vector<Override> overrides() const { return {}; }
  /// Opens what the demo reads and writes beside the record; must end before the observer.
  virtual Status attach(const Deployment& deployment, runtime::Observer& observer,
                        std::mutex& mutex) = 0;
  /// Called all the time, about every 20 ms.
  virtual void step() {}
  /// A line once a second; empty when there is nothing to tell.
  virtual std::string progress(const RunRecord& record) = 0;
  virtual bool over(const RunRecord& record) const = 0;
  /// Adds what this demo promises to what holds for every run.
  virtual void judge(const RunRecord& record, ResultSheet& sheet) const = 0;
};

/// MARVIN guides a visitor to `destination`; empty = where the visitor wants to go by itself.
/// `pixels`: every pixel of both depth cameras is rendered.
std::unique_ptr<Demo> guide_demo(const std::string& destination, bool pixels);
/// The meeting assistant finds a free room and brings two people.
std::unique_ptr<Demo> meeting_demo();

}  // namespace usher::operations
