// SPDX-License-Identifier: Apache-2.0
// What long work, a training or a diagnosis, has worked out so far, in pieces of seconds: results
// (scores of traces, steps of refits), and chains of steps, of which only the last state is kept.
// All pieces are deterministic, so each is kept under a hash of everything that it depends on; work
// that was stopped anywhere, and begins again with what it had, takes the same way to the same bits
// and only works on the pieces that are missing. The journal also knows how far the work is.
#ifndef PHYSPRING_TRAINER_JOURNAL_JOURNAL_H_
#define PHYSPRING_TRAINER_JOURNAL_JOURNAL_H_

#include <Eigen/Core>
#include <functional>
#include <map>
#include <mutex>
#include <string>
#include <vector>

#include "twin/effects/effect_values.h"
#include "twin/npz.h"
#include "twin/twin.h"

namespace physpring {

// A share of all work, from `first` to `last` of 0 to 1.
struct WorkShare {
  double first = 0, last = 1;

  double Size() const { return last - first; }
  double At(double part) const { return first + part * (last - first); }
  WorkShare Part(double from, double to) const { return {At(from), At(to)}; }
};

// Everything that a piece depends on, besides what all pieces have in common (recordings, options):
// numbers and words one after the other.
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
  using Arrays = std::map<std::string, NpzArray>;

  // The results that follow are so many, and this share of all work.
  void Stage(const WorkShare& share, int pieces, const std::string& status);

  // The result under `key`, or that of `work`, which is then kept. From any thread.
  Eigen::VectorXd Get(const PieceKey& key, const std::function<Eigen::VectorXd()>& work);

  // A chain of steps (work.h) after its last step.
  struct Chain {
    Eigen::VectorXd state;  // empty before the first step
    bool done = false;
    double part = 0;  // that is done, 0 to 1
    std::string status = {};
  };
  Chain FindChain(const std::string& hash);
  void KeepChain(const std::string& hash, const Chain& chain, const std::string& name,
                 double share);
  // Before a step: what the step before did.
  void Announce(const std::string& status);
  // The work is at this share at least; it is further by this share.
  void Reach(double share);
  void Advance(double share);

  // Results and chains as arrays, and back. Load throws Error if the arrays are none of a journal.
  // Not while pieces are worked on, but in `kept`.
  Arrays Save() const;
  void Load(const Arrays& arrays);

  // What `kept` is told of the piece.
  struct Piece {
    double share;               // of all work that is done
    const std::string& name;    // of the part of the work
    const std::string& status;  // in one line, for people
  };

  // Called before a piece that is missing is worked on; may throw to stop the work.
  std::function<void(double share, const std::string& status)> progress;
  // Called after it.
  std::function<void(const Piece& piece)> kept;
  // Called with the twin so far, from time to time.
  std::function<void(const Twin& twin)> reached;

 private:
  mutable std::mutex mutex_;
  std::map<std::string, Eigen::VectorXd> results_;  // by hash
  std::map<std::string, Chain> chains_;             // by hash
  WorkShare share_;
  int pieces_ = 1, done_ = 0;
  double at_ = 0;  // the share of all work that is done
  std::string status_;
};

}  // namespace physpring

#endif  // PHYSPRING_TRAINER_JOURNAL_JOURNAL_H_
