// SPDX-License-Identifier: Apache-2.0
// Contacts of a level's nodes with everything else in the model: ground, geoms of robots, nodes of
// other twins. MuJoCo finds them: geoms whose margins add up to less than 0 are listed in
// mjData.contact, as far as their gaps reach, but get no constraint forces before they overlap by
// more than that. The contact law (twin/contact_law.h) acts on them here, in every sub-step, with
// the surface taken as flat and moving along with its body:
//   u = v - s,   u' = Impact(u, n),   J = (I / m + W)^-1 (u' - u),   v += J / m
// s: velocity of the surface, W: inverse mass that the body shows at the node. The body gets -J,
// MuJoCo the mean force of a step. What else drives the body (motors, the other bodies it hits)
// MuJoCo only adds after this. So a body that is ten times as heavy as the nodes it touches goes on
// within the step as it moves (W = 0), and a lighter one as -J alone lets it. A mocap body goes on
// from its last pose to the one that MuJoCo finds it at (plugin/mocap_motion.h). Of the overlap
// that is left a part of s, along n, undoes a fifth in each step. A geom of higher priority than
// the node's brings its own friction, and takes the bounce. Otherwise what is pressed between
// fingers vibrates, and creeps out of the grip (docs/decisions, 048).
//
// What stands still is as the trainer's ground: s = 0, W = 0. It undoes a fifth of the overlap d
// beyond 1 mm, slowly:   v' . n >= min((d - 1 mm) / (5 H), 0.2 m/s)
#ifndef PHYSPRING_PLUGIN_SURFACES_H_
#define PHYSPRING_PLUGIN_SURFACES_H_

#include <mujoco/mujoco.h>

#include <Eigen/Core>
#include <vector>

#include "plugin/level.h"
#include "plugin/mocap_motion.h"
#include "twin/contact.h"
#include "twin/node_state.h"

namespace physpring {

class Surfaces {
 public:
  // `level` must outlive this.
  Surfaces(const mjModel* model, int instance, const Level& level);

  // How many numbers of plugin_state hold the last poses of mocap bodies.
  int state_size() const { return mocaps_.state_size(); }
  // To be called at the end of a step.
  void KeepPoses(const mjData* data, double* poses) const { mocaps_.Keep(data, poses); }

  // Has no contacts any more.
  void Forget();
  // Takes the contacts that are this instance's, at the nodes' positions of `state`.
  void Collect(const mjModel* model, mjData* data, const NodeStates<double>& state,
               const double* poses);

  bool empty() const { return touches_.empty(); }
  // The node of each contact.
  template <class Function>
  void ForEachNode(Function function) const {
    for (const Touch& touch : touches_) function(touch.node);
  }

  // The velocities of `next` <- those after the contacts of a sub-step of h seconds, at the
  // positions of `state`. Moves the surfaces on.
  void Apply(const NodeStates<double>& state, double h, NodeStates<double>* next);

  // Adds the forces on the other bodies to qfrc_passive: the impulses since Collect over `time`.
  void AddReactions(const mjModel* model, mjData* data, double time) const;

  // Calls function(node, body, impulse) for each contact that was hit since Collect. `node` and
  // `body` are MuJoCo's; `impulse` is what the body got, N m s and N s, about its centre of mass.
  // The node got the opposite of the linear part.
  template <class Function>
  void ForEachImpulse(Function function) const {
    for (const Touch& touch : touches_) {
      if (touch.impulse.isZero(0)) continue;
      function(level_->bodies.nodes[touch.node], bodies_[touch.body].id, touch.impulse);
    }
  }

 private:
  using Vector = Eigen::Vector3d;
  using Vector6 = Eigen::Matrix<double, 6, 1>;

  // Another body. Spatial vectors: first the angular part, then that of its centre of mass, in the
  // world's axes.
  struct Body {
    int id;
    bool moves;                                   // false: as the trainer's ground
    double lead;                                  // s, into the step: when it is where it was found
    Vector centre;                                // m, where it is now
    Vector6 velocity;                             // rad/s, m/s
    Vector6 impulse;                              // N m s, N s
    Eigen::Matrix<double, 6, 6> inverse_inertia;  // 0: goes on as it moves
  };
  struct Touch {
    int node;
    int body;  // index in bodies_
    ContactPair<double> law;
    Vector normal;    // the surface's, towards the node
    Vector start;     // where the node was
    double gap;       // from touching then, m; less than 0: overlap
    double advanced;  // by the surface since, along the normal, m
    Vector6 impulse;  // that the body got since, N m s, N s
  };

  void CollectContact(const mjModel* model, mjData* data, const NodeStates<double>& state,
                      const double* poses, const mjContact& contact);
  int FindBody(const mjModel* model, mjData* data, const double* poses, int body);
  void ReadMotion(const mjModel* model, mjData* data, Body* body);
  void ReadMocapMotion(const mjModel* model, const mjData* data, const double* poses, Body* body);
  void LetHeavyBodiesGoOn();
  static double Gap(const Touch& touch, const Vector& x);  // m, less than 0: overlap
  // Lets the node of a touch, at x with velocity v, hit the surface if it does; returns its
  // velocity.
  Vector HitFixed(const Vector& x, const Vector& v, double h, Touch* touch) const;
  Vector HitMoving(const Vector& x, const Vector& v, double h, Touch* touch);

  int instance_;
  std::vector<int> node_of_body_;  // -1: none
  const Level* level_;
  ContactLaws<double> laws_;
  MocapMotion mocaps_;
  double recovery_rate_ = 0;  // 1/s
  std::vector<Body> bodies_;
  std::vector<Touch> touches_;
  std::size_t fixed_ = 0;  // how many of them, the first ones, are with bodies that stand still
  std::vector<double> jacobian_, solution_;  // 6 x nv
};

}  // namespace physpring

#endif  // PHYSPRING_PLUGIN_SURFACES_H_
