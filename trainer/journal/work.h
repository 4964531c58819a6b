// SPDX-License-Identifier: Apache-2.0
// A part of long work: under which key the journal keeps its pieces, which share of all work it is,
// and what people call it. Straight-line code hands a Work from caller to callee; nothing else is
// needed to stop anywhere and to go on to the same bits.
#ifndef PHYSPRING_TRAINER_JOURNAL_WORK_H_
#define PHYSPRING_TRAINER_JOURNAL_WORK_H_

#include <string>
#include <utility>

#include "trainer/journal/journal.h"
#include "trainer/journal/packing.h"
#include "twin/twin.h"

namespace physpring {

// What one step of a chain did.
struct StepReport {
  bool done = false;   // it was the last step
  double part = 0;     // the part of the chain that is done, 0 to 1
  std::string status;  // what the step did, in one line, for people
};

class Work {
 public:
  // `context` is told before the status of each step; empty: nothing is.
  Work(Journal* journal, PieceKey key, const WorkShare& share = {}, std::string context = "")
      : journal_(journal), key_(std::move(key)), share_(share), context_(std::move(context)) {}

  // The part from `from` to `to` (0 to 1) of this work, which begins now. Its name is part of its
  // key; a report of where the time went lists it.
  Work Part(const std::string& name, double from, double to) const {
    Work part = Stretch(name, from, to);
    part.name_ = name;
    return part;
  }

  // The same, for a part that no report lists.
  Work Stretch(const std::string& word, double from, double to) const {
    Work part = *this;
    part.key_.Add(word);
    part.share_ = share_.Part(from, to);
    journal_->Reach(part.share_.first);
    return part;
  }

  // Item `i` of `count` equal ones, which are worked on at the same time.
  Work Item(int i, int count) const {
    Work item = *this;
    item.key_.Add(static_cast<double>(i));
    const double size = 1.0 / count;
    item.share_ = share_.Part(i * size, (i + 1) * size);
    return item;
  }

  // Takes `state` through step after step until one says that it was the last, from the last state
  // that the journal keeps of this chain. The chain is known by the key and by where it starts;
  // `step` must depend on nothing else. Any thread may call this.
  template <class State, class Step>  // StepReport step(State*)
  State Follow(State state, const Step& step) const {
    PieceKey key = key_;
    const std::string hash = key.Add(Pack(state)).Hash();
    Journal::Chain chain = journal_->FindChain(hash);
    if (chain.state.size() > 0) Unpack(chain.state, &state);
    if (chain.status.empty()) chain.status = context_ + name_;
    double part = chain.part;
    journal_->Advance(share_.Size() * part);
    while (!chain.done) {
      journal_->Announce(chain.status);
      const StepReport report = step(&state);
      const double reached = report.done ? 1 : report.part;
      chain = {Pack(state), report.done, reached, context_ + report.status};
      journal_->KeepChain(hash, chain, name_, share_.Size() * (reached - part));
      part = reached;
    }
    return state;
  }

  // Hands on the twin so far, at the end of a part. A checkpoint shows it.
  void Reached(const Twin& twin) const {
    if (journal_->reached) journal_->reached(twin);
  }

 private:
  Journal* journal_;
  PieceKey key_;
  WorkShare share_;
  std::string context_, name_;
};

}  // namespace physpring

#endif  // PHYSPRING_TRAINER_JOURNAL_WORK_H_
