// SPDX-License-Identifier: Apache-2.0
// What a diagnosis has worked out so far, in pieces of seconds: steps of fits, scores of traces;
// and how far its trainings are.
// All pieces are deterministic, so each is kept under a hash of everything that it depends on; a
// diagnosis that was stopped anywhere, and begins again with what it had, takes the same way to the
// same bits and only works on the pieces that are missing. It also knows how far the work is.
#ifndef PHYSPRING_TRAINER_DIAGNOSIS_JOURNAL_H_
#define PHYSPRING_TRAINER_DIAGNOSIS_JOURNAL_H_

#include <Eigen/Core>
#include <functional>
#include <map>
#include <mutex>
#include <string>
#include <vector>

#include "trainer/fitter.h"
#include "trainer/state_arrays.h"
#include "twin/effects/effect_values.h"

namespace physpring {

// A share of a diagnosis' work, from `first` to `last` of 0 to 1.
struct WorkShare {
  double first = 0, last = 1;

  double At(double part) const { return first + part * (last - first); }
  WorkShare Part(double from, double to) const { return {At(from), At(to)}; }
};

// Everything that a piece depends on, besides what all pieces of a diagnosis have in common (twin,
// recordings, options): numbers and words one after the other.
class PieceKey {
 public:
  explicit PieceKey(const std::string& kind) { Add(kind); }
  PieceKey& Add(const std::string& word);
  PieceKey& Add(double number);
  PieceKey& Add(const Eigen::VectorXd& numbers);
  PieceKey& Add(const std::vector<EffectValues>& effects);
  std::string Hash() const;

 private:
  std::string bytes_;
};

class Journal {
 public:
  // The work that follows is so many pieces, and this share of all.
  void Stage(const WorkShare& share, int pieces, const std::string& status);

  // The result under `key`, or that of `work`, which is then kept. From any thread.
  Eigen::VectorXd Get(const PieceKey& key, const std::function<Eigen::VectorXd()>& work);

  // Takes a fit to its end, from the last of its steps that is kept under `key`: this share of all
  // work. Not from several threads.
  void Finish(const PieceKey& key, const WorkShare& share, const std::string& status,
              Fitter* fitter);

  // The results, and back. Load throws Error if the arrays are none of a journal. Not while pieces
  // are worked on, but in `kept`.
  StateArrays Save() const;
  void Load(const StateArrays& state);

  // Called before a piece that is missing is worked on; may throw to stop the diagnosis.
  std::function<void(double share, const std::string& status)> progress;
  // Called after it.
  std::function<void()> kept;

 private:
  std::mutex mutex_;
  std::map<std::string, Eigen::VectorXd> results_;  // by hash
  std::map<std::string, StateArrays> fits_;         // after their last steps, by hash
  WorkShare share_;
  int pieces_ = 1, done_ = 0;
  std::string status_;
};

}  // namespace physpring

#endif  // PHYSPRING_TRAINER_DIAGNOSIS_JOURNAL_H_
