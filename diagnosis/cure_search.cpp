#include "diagnosis/cure_search.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <map>
#include <set>
#include <span>
#include <string>
#include <utility>

namespace crossgait {
namespace {

// Puts all of `more` behind the others.
void append(std::vector<Candidate> more, std::vector<Candidate>& candidates) {
  candidates.insert(candidates.end(), std::make_move_iterator(more.begin()),
                    std::make_move_iterator(more.end()));
}

void add_strengths(const Candidate& candidate, std::initializer_list<double> strengths,
                   std::vector<Candidate>& others) {
  if (!candidate.change.in_strength) return;
  for (const double strength : strengths) others.push_back(Search::in_strength(candidate, strength));
}

// The better ones of `candidates` beside themselves in other strengths.
void tune(Search& search, std::vector<Candidate>& candidates, std::size_t most, const Progress& progress) {
  std::vector<Candidate> others;
  for (std::size_t i = 0; i < candidates.size() && i < most; ++i)
    add_strengths(candidates[i], {0.6, 0.8, 1.25, 1.6}, others);
  search.glance(others, progress);
  append(std::move(others), candidates);
}

// The best of what was glanced at, over every command, and the best of these in finer strengths, walked
// whole.
std::vector<Candidate> walk_best(Search& search, std::vector<Candidate> glanced, const Progress& progress) {
  constexpr std::size_t kOnce = 12, kFiner = 2, kWhole = 5;
  std::vector<Candidate> best = best_of_fields(std::move(glanced), &Candidate::glance, 2, kOnce);
  search.once(best, part_of(progress, 0, 0.5));
  best = best_of_fields(std::move(best), &Candidate::once, 1, kOnce);
  std::vector<Candidate> finer;
  for (std::size_t i = 0; i < best.size() && i < kFiner; ++i)
    add_strengths(best[i], {0.7, 0.87, 1.15, 1.4}, finer);
  search.once(finer, part_of(progress, 0.5, 0.7));
  append(std::move(finer), best);
  best = best_of_fields(std::move(best), &Candidate::once, 1, kWhole);
  search.whole(best, part_of(progress, 0.7, 1));
  return best;
}

// Changes of one field. @param glanced  gets all that were looked at
std::vector<Candidate> search_singles(Search& search, std::vector<Candidate>& glanced,
                                      const Progress& progress) {
  constexpr std::size_t kGlanced = 24, kTuned = 12;
  glanced = search.changes(nullptr);
  search.glance(glanced, part_of(progress, 0, 0.5));
  std::vector<Candidate> best = best_of_fields(glanced, &Candidate::glance, 2, kGlanced);
  tune(search, best, kTuned, part_of(progress, 0.5, 0.7));
  return walk_best(search, std::move(best), part_of(progress, 0.7, 1));
}

// Of fields with very many changes, as orders are, the first of the table and those that did best alone:
// beside another change only these are tried.
class BestAlone {
 public:
  // @param glanced  changes of one field, all that were looked at
  explicit BestAlone(const std::vector<Candidate>& glanced) {
    constexpr std::size_t kBest = 16, kFirst = 16;
    std::map<std::string, std::size_t> count;
    for (const Candidate& one : glanced) {
      if (++count[one.field] <= kFirst) best_[one.field].insert(one.to);
    }
    for (const Candidate& one : best_of_fields(glanced, &Candidate::glance, kBest, glanced.size()))
      best_[one.field].insert(one.to);
    std::erase_if(best_, [&count](const auto& field) { return count.at(field.first) <= kBest + kFirst; });
  }

  bool has(const Candidate& second) const {
    const auto found = best_.find(second.fields.back());
    return found == best_.end() || found->second.contains(second.change.to);
  }

 private:
  std::map<std::string, std::set<std::string>> best_;  // by field, what they change it to
};

// Changes of a second field on top of some first ones.
std::vector<Candidate> search_pairs_of(Search& search, std::span<const Candidate> firsts,
                                       const BestAlone& alone, const Progress& progress) {
  constexpr std::size_t kEach = 6, kTuned = 3;
  std::vector<Candidate> best;
  const double share = 0.8 / static_cast<double>(firsts.size());
  double done = 0;
  for (const Candidate& first : firsts) {
    if (search.is_late()) break;
    std::vector<Candidate> seconds = search.changes(&first);
    std::erase_if(seconds, [&alone](const Candidate& second) { return !alone.has(second); });
    search.glance(seconds, part_of(progress, done, done + 0.75 * share));
    seconds = best_of_fields(std::move(seconds), &Candidate::glance, 1, kEach);
    tune(search, seconds, kTuned, part_of(progress, done + 0.75 * share, done + share));
    done += share;
    append(std::move(seconds), best);
  }
  return walk_best(search, std::move(best), part_of(progress, 0.8, 1));
}

// Whether it leaves a score that only policies of good habits have.
bool settles(const Candidate& candidate, const Search& search) {
  constexpr double kDoubtful = 0.5;
  return cures(candidate, search) && candidate.whole->mean() < kDoubtful;
}

bool any_settles(const std::vector<Candidate>& candidates, const Search& search) {
  return std::any_of(candidates.begin(), candidates.end(),
                     [&search](const Candidate& candidate) { return settles(candidate, search); });
}

bool goes_somewhere(const Candidate& candidate) {
  return std::ranges::all_of(candidate.glance->walks, [](const WalkMeasure& walk) {
    return !walk.fell && walk.speed > std::hypot(walk.asked.vx, walk.asked.vy) / 2;
  });
}

// The changes that a second one is tried on, one of a field. What keeps a robot from falling by keeping it
// from walking comes before half of a true pair, so that a few are not enough, and every third is one with
// which it goes somewhere, if not where it is asked.
std::vector<Candidate> firsts_of_pairs(const std::vector<Candidate>& glanced) {
  constexpr std::size_t kMost = 15, kOneIn = 3;
  std::vector<Candidate> best = best_of_fields(glanced, &Candidate::glance, 1, glanced.size());
  std::vector<Candidate> firsts;
  while (firsts.size() < kMost && !best.empty()) {
    auto next = best.begin();
    if (firsts.size() % kOneIn == kOneIn - 1) {
      next = std::ranges::find_if(best, goes_somewhere);
      if (next == best.end()) next = best.begin();
    }
    firsts.push_back(std::move(*next));
    best.erase(next);
  }
  return firsts;
}

bool is_same_change(const Candidate& a, const Candidate& b) {
  return a.fields == b.fields && a.change.to == b.change.to;
}

// Further changes to try a second one on: what did best as a second, in the strength in which it did, since
// its fellow may have been another fault's stand-in; and what other programs mean without saying it, of which
// nothing shows as long as the robot falls at once for another fault.
std::vector<Candidate> later_firsts(const std::vector<Candidate>& glanced,
                                    const std::vector<Candidate>& firsts, std::vector<Candidate> pairs) {
  constexpr std::size_t kSeconds = 4, kMost = 12;
  std::vector<Candidate> later;
  const auto add = [&](const Candidate& one) {
    const auto is_it = [&one](const Candidate& other) { return is_same_change(one, other); };
    if (later.size() < kMost && std::ranges::none_of(firsts, is_it) && std::ranges::none_of(later, is_it))
      later.push_back(one);
  };
  std::ranges::stable_sort(pairs, {}, [](const Candidate& pair) { return pair.whole->mean(); });
  for (const Candidate& pair : pairs) {
    if (later.size() == kSeconds) break;
    const auto alone = std::ranges::find(glanced, std::vector{pair.fields.back()}, &Candidate::fields);
    if (alone != glanced.end()) add(Search::with_change(*alone, pair.change));
  }
  for (const Candidate& one : glanced)
    if (one.change.usual) add(one);
  return later;
}

// Changes on top of these first ones, of a few at a time and as long as none settles it.
std::vector<Candidate> search_in_groups(Search& search, std::span<const Candidate> firsts,
                                        const BestAlone& alone, const Progress& progress) {
  constexpr std::size_t kTogether = 5;
  std::vector<Candidate> found;
  for (std::size_t i = 0; i < firsts.size() && !any_settles(found, search); i += kTogether) {
    const std::size_t count = std::min(kTogether, firsts.size() - i);
    const auto share = [&](std::size_t k) {
      return static_cast<double>(k) / static_cast<double>(firsts.size());
    };
    append(search_pairs_of(search, firsts.subspan(i, count), alone,
                           part_of(progress, share(i), share(i + count))),
           found);
  }
  return found;
}

// Changes of two fields.
std::vector<Candidate> search_pairs(Search& search, const std::vector<Candidate>& glanced,
                                    const Progress& progress) {
  const BestAlone alone(glanced);
  const std::vector<Candidate> firsts = firsts_of_pairs(glanced);
  std::vector<Candidate> found = search_in_groups(search, firsts, alone, part_of(progress, 0, 0.6));
  if (any_settles(found, search) || search.was_cut_short()) return found;
  append(search_in_groups(search, later_firsts(glanced, firsts, found), alone, part_of(progress, 0.6, 1)),
         found);
  return found;
}

}  // namespace

bool cures(const Candidate& candidate, const Search& search) {
  return does_what_is_asked(*candidate.whole, search.whole_test().seeds);
}

std::vector<Candidate> search_cures(Search& search, const Progress& progress) {
  std::vector<Candidate> glanced;
  std::vector<Candidate> found = search_singles(search, glanced, part_of(progress, 0, 0.4));
  if (any_settles(found, search)) return found;
  append(search_pairs(search, glanced, part_of(progress, 0.4, 1)), found);
  return found;
}

}  // namespace crossgait
