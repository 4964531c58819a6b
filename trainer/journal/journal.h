// SPDX-License-Identifier: Apache-2.0
// A journal keeps what long work, a training or a diagnosis, has worked out so far. The work comes
// in pieces of seconds: results (scores of traces, steps of refits), and chains of steps, of which
// only the last state is kept. All pieces are deterministic, so each is kept under a hash of
// everything that it depends on. Work that was stopped anywhere may begin again with what it had.
// It then takes the same way to the same bits, and only works on the pieces that are missing. The
// journal also knows how far the work is.
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

  // Says that so many results follow, and that they are this share of all work.
  void Stage(const WorkShare& share, int pieces, const std::string& status);

  // The result under `key`; if there is none, that of `work`, which is then kept. Any thread may
  // call this.
  Eigen::VectorXd Get(const PieceKey& key, const std::function<Eigen::VectorXd()>& work);

  // A chain of steps (work.h) after its last step.
  struct Chain {
    Eigen::VectorXd state;  // empty before the first step
    bool done = false;
    double part = 0;  // the part of the chain that is done, 0 to 1
    std::string status = {};
  };
  Chain FindChain(const std::string& hash);
  void KeepChain(const std::string& hash, const Chain& chain, const std::string& name,
                 double share);
  // Called before a step. `status` is what the step before did.
  void Announce(const std::string& status);
  // Reach says that the work is at this share at least, Advance that it is further by this share.
  void Reach(double share);
  void Advance(double share);

  // Results and chains as arrays, and back. Load throws Error if the arrays are none of a journal.
  // Neither may be called while pieces are worked on, except in `kept`.
  Arrays Save() const;
  void Load(const Arrays& arrays);

  // What `kept` is told of the piece.
  struct Piece {
    double share;               // the share of all work that is done
    const std::string& name;    // the name of the part of the work
    const std::string& status;  // what was done, in one line, for people
  };

  // Called before a piece that is missing is worked on; may throw to stop the work.
  std::function<void(double share, const std::string& status)> progress;
  // Called after such a piece.
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
