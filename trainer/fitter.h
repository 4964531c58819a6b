// SPDX-License-Identifier: Apache-2.0
// A way to fit a twin to recordings, as a sequence of short steps. Everything that the next step
// depends on is in the saved state, so a run that was stopped anywhere and resumed gives the same
// bits as one that was not.
#ifndef PHYSPRING_TRAINER_FITTER_H_
#define PHYSPRING_TRAINER_FITTER_H_

#include <map>
#include <string>
#include <vector>

#include "twin/npz.h"
#include "twin/recording.h"
#include "twin/twin.h"

namespace physpring {

// Recordings of one object to fit; all with the same numbers of points, interior and controllers.
struct FitData {
  std::vector<Recording> recordings;
  std::vector<int>
      continuous_recording;  // of each: recordings cut from the same run share a number
};

class Fitter {
 public:
  virtual ~Fitter() = default;

  // Does the next piece of work (seconds, not minutes). False when there was nothing left to do.
  virtual bool Step() = 0;

  // Share of the work done, 0 to 1, and what the last step did, in one line for people.
  virtual double Progress() const = 0;
  virtual std::string Status() const = 0;

  // What the next step is part of, for a report of where the time went; empty: of none.
  virtual std::string Part() const { return "fitting"; }

  // The state between two steps, as arrays for Twin::training_state, and back. Load throws Error if
  // the arrays do not belong to this fit.
  virtual std::map<std::string, NpzArray> Save() const = 0;
  virtual void Load(const std::map<std::string, NpzArray>& state) = 0;

  // The twin as fitted so far.
  virtual Twin Result() const = 0;
};

}  // namespace physpring

#endif  // PHYSPRING_TRAINER_FITTER_H_
