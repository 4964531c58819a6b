// SPDX-License-Identifier: Apache-2.0
// What a page says and shows of an effect with given values: in plain words what it is, and where
// on the body and in which direction it acts. Numbers and words only; report/ draws them.
#ifndef PHYSPRING_TWIN_EFFECTS_EFFECT_PICTURE_H_
#define PHYSPRING_TWIN_EFFECTS_EFFECT_PICTURE_H_

#include <Eigen/Core>
#include <optional>
#include <string>
#include <vector>

namespace physpring {

struct EffectPicture {
  // A place of the body, in the reference configuration, and what holds it there, if anything: m.
  struct Place {
    Eigen::Vector3d place;
    std::optional<Eigen::Vector3d> anchor;
  };
  // A direction that is the same everywhere and always, in world axes.
  struct Arrow {
    std::string label;
    std::string unit;  // of `vector`
    Eigen::Vector3d vector;
    bool declared = false;  // what was taken to be so without the effect
  };
  // Values that vary along the body (body_coordinate.h): from one end to the other, evenly spaced.
  struct Profile {
    std::string label;
    int first, count;  // which of the effect's values
  };
  // A vector that varies in time: x, y and z of values every `interval` seconds.
  struct Course {
    std::string label;
    int first, count;  // the values of x; those of y and z follow
    double interval;   // s
  };

  std::string lacks;     // completes "the twin lacks ...": "the drag of the air"
  bool formula = false;  // `lacks` is a formula with the values that were found
  int amount = -1;       // the value that says how much of it; -1: none alone does
  // Where it acts, if there is nothing to draw: completes "it acts ...".
  std::string where = "everywhere in the body";
  std::vector<Place> places;
  std::vector<Arrow> arrows;
  std::vector<Profile> profiles;
  std::vector<Course> courses;
};

}  // namespace physpring

#endif  // PHYSPRING_TWIN_EFFECTS_EFFECT_PICTURE_H_
