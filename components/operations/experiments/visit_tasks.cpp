#include "operations/experiments/visit_tasks.hpp"

#include <array>

namespace usher::operations {

std::span<const VisitTask> visit_tasks() {
  static const std::array kTasks{
      VisitTask{"1 approach, wait to be greeted", {"introduction", "location_ask"}},
      VisitTask{"2 request a map", {"location_show", "guide_ask"}},
      VisitTask{"3 request to be guided", {"guide_options", "guide_start"}},
      VisitTask{"4 follow", {"guide_active", "guide_success"}},
      VisitTask{"5 request to be guided back", {"end_ask", "guide_options", "guide_start"}},
      VisitTask{"6 follow back", {"guide_active", "guide_success"}},
      VisitTask{"7 end", {"end_ask", "end"}}};
  return kTasks;
}

std::vector<double> tasks_done(std::span<const std::pair<double, std::string>> states) {
  std::vector<double> done;
  std::size_t next = 0;  // state of the task
  for (const auto& [time, state] : states) {
    if (done.size() == visit_tasks().size()) break;
    const VisitTask& task = visit_tasks()[done.size()];
    if (state != task.states[next]) continue;
    if (++next < task.states.size()) continue;
    next = 0;
    done.push_back(time);
  }
  return done;
}

std::span<const Statement> table_7_1() {
  static constexpr std::array kTable{Statement{"voice easy to understand", 4.7, 0.5},
                                     Statement{"voice loud enough", 4.4, 0.7},
                                     Statement{"text large enough", 4.8, 0.4},
                                     Statement{"layout helped", 4.4, 0.7},
                                     Statement{"distance comfortable", 4.1, 0.6},
                                     Statement{"understood my voice well", 3.3, 1.1},
                                     Statement{"voice more useful than touch", 3.8, 1.2},
                                     Statement{"requesting my location easy", 4.3, 0.7},
                                     Statement{"map easy to read", 4.5, 0.9},
                                     Statement{"requesting to be guided easy", 4.3, 0.8},
                                     Statement{"moved too slowly", 2.2, 1.0},
                                     Statement{"moved too quickly", 1.9, 0.7},
                                     Statement{"upper body improved it", 3.6, 1.1}};
  return kTable;
}

}  // namespace usher::operations
