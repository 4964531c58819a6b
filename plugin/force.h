// SPDX-License-Identifier: Apache-2.0
// The plugin physpring.force: sensors of the forces with which twins act on a body, as means over
// MuJoCo's step of length H. MuJoCo's own sensors do not see the impulses J of the contact law.
//   F = sum J / H + sum f,   T = sum (L + r x J) / H + sum (t + r x f)
// J, L: impulses of the law and of springs on what holds them (physpring.springs,
// physpring.contact), about the centre of a body; f, t: forces of contacts that are left to MuJoCo;
// r: from the point that a sensor is about. It is computed after all forces (mjSTAGE_ACC).
//
// A sensor is of
//   a body: F and T on its geoms and on those of bodies that are fixed in it, about its centre of
//     mass, in the world's axes;
//   a site: those on its body, about the site, in its axes;
//   the parent of a level (plugin/level.h): F on each node, from all but nodes of the level.
// MuJoCo asks for the size of a sensor before it knows its object, hence the attribute `nodes`.
#ifndef PHYSPRING_PLUGIN_FORCE_H_
#define PHYSPRING_PLUGIN_FORCE_H_

#include <mujoco/mujoco.h>

#include <Eigen/Core>
#include <string>
#include <vector>

#include "plugin/surfaces.h"

namespace physpring {

class ForceSensor {
 public:
  static constexpr const char* kName = "physpring.force";
  static const std::vector<const char*>& AttributeNames();

  // Throws Error, one line that names the sensor and what is wrong with it.
  ForceSensor(const mjModel* model, int instance);

  static int StateSize(const mjModel*, int) { return 0; }
  // How many numbers each sensor of an instance gives.
  static int SensorSize(const mjModel* model, int instance, int sensor);

  void Reset(int, double*) const {}
  void Compute(const mjModel* model, mjData* data, int instance);
  void Advance(const mjModel*, mjData*, int) {}

 private:
  using Vector = Eigen::Vector3d;
  using Vector6 = Eigen::Matrix<double, 6, 1>;  // first the angular part

  // A body with those that are fixed in it.
  using Parts = std::vector<int>;
  struct Sensor {
    int address;  // in sensordata
    bool is_of_nodes;
    int site;                  // -1: none
    std::vector<Parts> parts;  // of the body, or of each node
  };

  // `nodes`: how many the attribute says; 0 where it is not given.
  static Sensor ReadSensor(const mjModel* model, int sensor, int nodes, const std::string& where);
  static std::vector<Parts> ReadNodes(const mjModel* model, int body, int count,
                                      const std::string& where);

  // The following add to wrench_.
  void AddImpulses(const mjModel* model, const mjData* data);
  void AddTouches(const mjData* data, const Surfaces& surfaces);
  void AddContacts(const mjModel* model, const mjData* data);
  void AddAt(const mjData* data, const double* point, const Vector& force, int body);

  // What acts on a body with its parts, about a point.
  Vector6 Sum(const mjData* data, const Parts& parts, const double* point) const;
  void Write(const Sensor& sensor, mjData* data) const;

  std::vector<int> level_of_body_;  // the instance of the twin that it is a node of; -1: none
  std::vector<Sensor> sensors_;
  Eigen::Matrix<double, 6, Eigen::Dynamic> wrench_;  // on each body, about its centre of mass
};

}  // namespace physpring

#endif  // PHYSPRING_PLUGIN_FORCE_H_
