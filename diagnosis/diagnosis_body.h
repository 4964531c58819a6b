// SPDX-License-Identifier: Apache-2.0
// The models of the body that a diagnosis adds effects to.
//   A twin that was trained on one of the recordings has bent its choice of neighbours, its common
//   factors and its single springs to what its model lacks. Whatever it chose is open again: every
//   neighbour count with either treatment of controllers is a body of equal springs, and which one
//   is right is found together with the effect. One more begins where the training ended, as a
//   smooth body (trainer/bodies/smooth_body.h): training looks for the right valley with more care.
//   A twin that was trained on other recordings knows its object: its springs are the only body.
//   They move by what a smooth body has of numbers, since no training is without errors, and these
//   must not be taken for effects.
//   A chain that bends (trainer/bodies/bending_chain.h) is the only body, too, whatever it was
//   trained on. Its own parameters hardly move: a few common factors can bend to little. What it
//   has of effects belongs to it, and stays.
#ifndef PHYSPRING_DIAGNOSIS_DIAGNOSIS_BODY_H_
#define PHYSPRING_DIAGNOSIS_DIAGNOSIS_BODY_H_

#include <string>
#include <vector>

#include "twin/recording.h"
#include "twin/twin.h"

namespace physpring {

struct DiagnosisBody {
  SpringMassSystem base;  // without effects, except a chain's own
  bool controller_velocity = true;
  enum class Kind {
    kOpen,     // begins as stiff as fits best
    kTrained,  // begins as it was trained, and moves as a smooth body
    kTrusted   // stays about as it was trained: its own parameters hardly move
  } kind = Kind::kOpen;
  std::string label;
};

// The bodies that a diagnosis tries, the twin's own model first; never empty. `recording` is one of
// the twin's object.
std::vector<DiagnosisBody> BodiesOf(const Twin& twin, const Recording& recording, bool trained_on);

// Whether springs spread in all three directions around most nodes, and the body is no rod: the
// bending of a solid is its springs' own.
bool IsSolid(const SpringMassSystem& system);

}  // namespace physpring

#endif  // PHYSPRING_DIAGNOSIS_DIAGNOSIS_BODY_H_
