// SPDX-License-Identifier: Apache-2.0
// Small scenes with the sensors physpring.force.
#ifndef PHYSPRING_TESTS_SUPPORT_FELT_SCENE_H_
#define PHYSPRING_TESTS_SUPPORT_FELT_SCENE_H_

#include <string>

#include "tests/support/level_scene.h"
#include "tests/support/simulation.h"

namespace physpring {

inline std::string Replaced(std::string text, const std::string& from, const std::string& to) {
  for (std::size_t at = text.find(from); at != std::string::npos; at = text.find(from, at)) {
    text.replace(at, from.size(), to);
    at += to.size();
  }
  return text;
}

inline std::string OfBody(const std::string& body, const std::string& config = "") {
  return R"(<plugin plugin="physpring.force" objtype="body" objname=")" + body + "\">" + config +
         "</plugin>";
}

inline std::string OfNodes(const std::string& parent, int nodes) {
  return OfBody(parent, R"(<config key="nodes" value=")" + std::to_string(nodes) + "\"/>");
}

// A level's MJCF with sensors and other sections.
inline std::string Mjcf(const SpringMassSystem& system, const LevelSceneOptions& options,
                        const std::string& sensors, const std::string& sections = "") {
  return Replaced(LevelMjcf(system, options), "</mujoco>",
                  R"(<extension><plugin plugin="physpring.force"/></extension>)"
                  "<sensor>" +
                      sensors + "</sensor>" + sections + "</mujoco>");
}

// A scene with sensors.
struct Felt {
  ModelPtr model;
  DataPtr data;

  explicit Felt(const std::string& mjcf) : model(CompileMjcf(mjcf)), data(MakeData(*model)) {}

  void Run(int steps) {
    for (int i = 0; i < steps; ++i) Step(*model, data.get());
  }
  Eigen::Map<const Eigen::VectorXd> All() const {
    return {data->sensordata, static_cast<Eigen::Index>(model->nsensordata)};
  }
  Eigen::VectorXd Of(int sensor) const {
    return All().segment(model->sensor_adr[sensor], model->sensor_dim[sensor]);
  }
  Eigen::VectorXd Mean(int steps) {
    Eigen::VectorXd sum = Eigen::VectorXd::Zero(All().size());
    for (int i = 0; i < steps; ++i) {
      Run(1);
      sum += All();
    }
    return sum / steps;
  }
};

// Four nodes that springs join.
inline SpringMassSystem FourNodes(const Points& at) {
  SpringMassSystem four = Particles(at, 0.05);
  for (int a = 0; a < 4; ++a) {
    for (int b = 0; b < a; ++b) AddSpring(a, b, 500, (at.col(a) - at.col(b)).norm(), 1, &four);
  }
  four.contact = {{0.1, 0.5}, {0, 0}, 0};
  four.contact_radius.setConstant(0.01);
  return four;
}

// Three of them stand on the floor.
inline SpringMassSystem Pyramid() {
  return FourNodes((Points(3, 4) << 0, 0.1, 0.05, 0.05,  //
                    0, 0, 0.09, 0.03,                    //
                    0.01, 0.01, 0.01, 0.09)
                       .finished());
}

// A square in the air.
inline SpringMassSystem Square() {
  return FourNodes((Points(3, 4) << 0, 0.1, 0, 0.1,  //
                    0, 0, 0.06, 0.06,                //
                    0.03, 0.03, 0.03, 0.03)
                       .finished());
}

}  // namespace physpring

#endif  // PHYSPRING_TESTS_SUPPORT_FELT_SCENE_H_
