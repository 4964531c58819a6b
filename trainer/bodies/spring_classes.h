// SPDX-License-Identifier: Apache-2.0
// Springs that are alike: those of about the same rest length, as the springs along, across and
// diagonal of a regular mesh, and the springs of controllers.
#ifndef PHYSPRING_TRAINER_BODIES_SPRING_CLASSES_H_
#define PHYSPRING_TRAINER_BODIES_SPRING_CLASSES_H_

#include <limits>
#include <vector>

#include "twin/spring_mass_system.h"

namespace physpring {

struct SpringClassOptions {
  double jump = 1.03;  // a class ends where the sorted lengths jump by this factor
  int equal = 6;       // so many, equally filled, where that gives many or wide ones
  // Of them, springs that are longer are in finer classes, of at most so many.
  struct Finer {
    double beyond = std::numeric_limits<double>::infinity();  // m
    int springs = 0;
    bool operator==(const Finer&) const = default;
  } finer = {};
  // Springs of controllers have classes apart from those of length: the nearest springs of all
  // controllers are one, the second nearest ones another, and so on.
  bool hands_apart = false;
  // Springs of a regular mesh that run in other directions are of other classes of length, unless
  // there are too many of them.
  bool directions = false;
};

struct SpringClasses {
  std::vector<int> of_spring;  // 0 <= class < count
  int count = 0;
  int lengths = 0;         // classes below this one are of length (and direction), in its order
  bool irregular = false;  // lengths fall into no classes: equally filled ones cut their range
  // Of each class of length, whether its springs are much like those of the class before: their
  // lengths differ by little in an irregular mesh, or by nothing where directions differ.
  std::vector<bool> like_the_last = {};
};

SpringClasses ClassesOf(const SpringMassSystem& system, const SpringClassOptions& options);

// All springs in one class.
SpringClasses OneClass(const SpringMassSystem& system);

}  // namespace physpring

#endif  // PHYSPRING_TRAINER_BODIES_SPRING_CLASSES_H_
