// SPDX-License-Identifier: Apache-2.0
// All effects, one line each, in the order in which a diagnosis lists them:
//   TWIN(NAME)     a twin may have it: MakeNAME in twin/effects/
//   SCENE(NAME)    MuJoCo can simulate it for a recording: MakeSceneNAME in rollout/effects/
//   BOTH(NAME)     both
#ifndef PHYSPRING_TWIN_EFFECTS_LIST_H_
#define PHYSPRING_TWIN_EFFECTS_LIST_H_

#define PHYSPRING_EFFECTS(TWIN, SCENE, BOTH) \
  BOTH(AirDrag)                              \
  BOTH(GravityDirection)                     \
  BOTH(Stiffening)                           \
  BOTH(TensionOnly)                          \
  BOTH(Yield)                                \
  BOTH(DryFriction)                          \
  TWIN(Viscoelastic)                         \
  TWIN(Bending)                              \
  TWIN(BendingDamping)                       \
  TWIN(BendingFriction)                      \
  TWIN(RestBend)                             \
  TWIN(Twist)                                \
  BOTH(MassDistribution)                     \
  BOTH(Tether)                               \
  BOTH(RestLength)                           \
  BOTH(ControlLatency)                       \
  BOTH(GroundContact)                        \
  BOTH(StiffnessDrift)                       \
  BOTH(UniformForce)                         \
  TWIN(Custom)                               \
  SCENE(MovingAttraction)

// For those that one of the two folders does not have.
#define PHYSPRING_NO_EFFECT(NAME)

#endif  // PHYSPRING_TWIN_EFFECTS_LIST_H_
