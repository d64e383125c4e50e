// Clusters and the outlier: on words that are set by hand, and on made-up runs with a fault that is known.
#include "parity/consensus.h"

#include <algorithm>
#include <map>

#include <gtest/gtest.h>

#include "physics/core/error.h"
#include "physics/core/random.h"
#include "physics/engine/physics_backend.h"

namespace crossgait {
namespace {

using Indices = std::vector<std::size_t>;

/// Words of pairs by the engines' names; all others agree. A pair's gap is 0.1 margins unless it is given.
struct Said {
  std::vector<JudgedEngine> engines;
  std::map<std::string, Word> words = {};
  std::map<std::string, double> gaps = {};

  Consensus stand() const {
    std::vector<Verdict> pairs;
    for (std::size_t i = 0; i < engines.size(); ++i) {
      for (std::size_t k = i + 1; k < engines.size(); ++k) {
        Verdict pair;
        pair.a = engines[i].name;
        pair.b = engines[k].name;
        StatisticVerdict slip, way;
        slip.statistic.key = slip.statistic.name = "slip";
        way.statistic.key = way.statistic.name = "way";
        way.word = Word::kAgrees;
        const auto word = words.find(pair.a + pair.b);
        pair.word = slip.word = word == words.end() ? Word::kAgrees : word->second;
        const auto gap = gaps.find(pair.a + pair.b);
        slip.margin = 2;
        slip.gap.high = slip.margin * (gap == gaps.end() ? 0.1 : gap->second);
        pair.statistics = {slip, way};
        EXPECT_EQ(pair_index(i, k, engines.size()), pairs.size());
        pairs.push_back(pair);
      }
    }
    return crossgait::find_consensus(engines, pairs);
  }
};

constexpr Word kApart = Word::kDiffers, kUndecided = Word::kUnresolved;

TEST(Consensus, OneAgainstOthersOfTwoLawsStandsApart) {
  const Consensus s = Said{{{"a", "1", "1"}, {"b", "2", "2"}, {"c", "3", "3"}, {"d", "4", "4"}},
                           {{"ac", kApart}, {"bc", kApart}, {"cd", kApart}}}
                          .stand();
  EXPECT_EQ(s.clusters, (std::vector<Indices>{{0, 1, 3}, {2}}));
  EXPECT_EQ(s.outlier, Indices{2});
  EXPECT_EQ(s.statistics, std::vector<std::string>{"slip"});
  EXPECT_NE(s.reason.find("a, b, d"), std::string::npos) << s.reason;
}

TEST(Consensus, EnginesOfOneLawAreOneVote) {
  // Three against one, but two laws: soft and hard.
  const std::map<std::string, Word> apart{{"ad", kApart}, {"bd", kApart}, {"cd", kApart}};
  const Consensus two =
      Said{{{"a", "1", "1"}, {"b", "1", "1"}, {"c", "1", "1"}, {"d", "2", "2"}}, apart}.stand();
  EXPECT_TRUE(two.outlier.empty());
  EXPECT_NE(two.reason.find("one vote"), std::string::npos) << two.reason;
  EXPECT_EQ(two.clusters, (std::vector<Indices>{{0, 1, 2}, {3}}));
  // Of three laws, all engines of one stand apart together.
  const Consensus law = Said{{{"a", "1", "1"}, {"b", "1", "1"}, {"c", "2", "2"}, {"d", "3", "3"}},
                             {{"ac", kApart}, {"ad", kApart}, {"bc", kApart}, {"bd", kApart}}}
                            .stand();
  EXPECT_EQ(law.outlier, (Indices{0, 1}));
  // Three laws, but two that differ from each other and from the third: nobody stands against a majority.
  const Consensus all = Said{{{"a", "1", "1"}, {"b", "2", "2"}, {"c", "3", "3"}},
                             {{"ab", kApart}, {"ac", kApart}, {"bc", kApart}}}
                            .stand();
  EXPECT_TRUE(all.outlier.empty());
  EXPECT_EQ(all.clusters.size(), 3U);
}

TEST(Consensus, LawsOfOneFamilyThatDoNotDifferAreOneVote) {
  // Three rigid laws against a compliant one: of two opinions nobody can say which is odd.
  const std::vector<JudgedEngine> engines{
      {"a", "1", "compliant"}, {"b", "2", "rigid"}, {"c", "3", "rigid"}, {"d", "4", "rigid"}};
  const std::map<std::string, Word> apart{{"ab", kApart}, {"ac", kApart}, {"ad", kApart}};
  const Consensus soft = Said{engines, apart}.stand();
  EXPECT_TRUE(soft.outlier.empty());
  EXPECT_NE(soft.reason.find("one family"), std::string::npos) << soft.reason;
  EXPECT_EQ(soft.outlier_by_law, Indices{0}) << "said beside it";
  // One that differs from its relatives is an opinion of its own, and stands against two.
  const Consensus hard = Said{engines, {{"ab", kApart}, {"bc", kApart}, {"bd", kApart}}}.stand();
  EXPECT_EQ(hard.outlier, Indices{1});
  EXPECT_EQ(hard.outlier_by_law, Indices{1});
}

TEST(Consensus, AnEngineThatLeavesItsOwnLawStandsApart) {
  // a and b share a law; b has a fault.
  const Consensus s = Said{{{"a", "1", "1"}, {"b", "1", "1"}, {"c", "2", "2"}, {"d", "3", "3"}},
                           {{"ab", kApart}, {"bc", kApart}, {"bd", kApart}}}
                          .stand();
  EXPECT_EQ(s.outlier, Indices{1});
}

TEST(Consensus, NamesNobodyWhileAPairIsUnresolved) {
  const std::vector<JudgedEngine> engines{{"a", "1", "1"}, {"b", "2", "2"}, {"c", "3", "3"}, {"d", "4", "4"}};
  // The outlier's own pair, and a pair of the others.
  for (const std::string open : {"cd", "ab"}) {
    std::map<std::string, Word> words{{"ac", kApart}, {"bc", kApart}, {"cd", kApart}};
    words[open] = kUndecided;
    const Consensus s = Said{engines, words}.stand();
    EXPECT_TRUE(s.outlier.empty()) << open;
    EXPECT_NE(s.reason.find("not settled"), std::string::npos) << s.reason;
  }
}

TEST(Consensus, TwoThatStandApartAreNoOutlier) {
  const Consensus s = Said{{{"a", "1", "1"}, {"b", "2", "2"}, {"c", "3", "3"}, {"d", "4", "4"}},
                           {{"ac", kApart}, {"bc", kApart}, {"ad", kApart}, {"bd", kApart}}}
                          .stand();
  EXPECT_EQ(s.clusters, (std::vector<Indices>{{0, 1}, {2, 3}}));
  EXPECT_TRUE(s.outlier.empty());
  EXPECT_NE(s.reason.find("{a, b}, {c, d}"), std::string::npos) << s.reason;
}

TEST(Consensus, OfAChainTheNearerAreACluster) {
  // a and b agree, b and c agree, a and c do not; b is nearer to c.
  Said chain{
      {{"a", "1", "1"}, {"b", "2", "2"}, {"c", "3", "3"}}, {{"ac", kApart}}, {{"ab", 0.9}, {"bc", 0.2}}};
  Consensus s = chain.stand();
  EXPECT_EQ(s.clusters, (std::vector<Indices>{{1, 2}, {0}}));
  EXPECT_EQ(s.bridges, Indices{0});  // a and b
  EXPECT_TRUE(s.outlier.empty());
  chain.gaps = {{"ab", 0.2}, {"bc", 0.9}};
  s = chain.stand();
  EXPECT_EQ(s.clusters, (std::vector<Indices>{{0, 1}, {2}}));
  EXPECT_EQ(s.bridges, Indices{2});
}

TEST(Consensus, AllThatAgreeAreOneCluster) {
  const Consensus s = Said{{{"a", "1", "1"}, {"b", "2", "2"}, {"c", "3", "3"}}}.stand();
  EXPECT_EQ(s.clusters, (std::vector<Indices>{{0, 1, 2}}));
  EXPECT_TRUE(s.bridges.empty());
  EXPECT_EQ(s.reason, "all agree");
}

/// Four engines of four laws on made-up runs. Distance 1 m, give or take 0.1 m by the start, which all share,
/// and 0.02 m by the engine; `fault` m more in one of them.
struct Planted {
  std::uint64_t seed;
  std::size_t faulty;
  double fault;

  Consensus stand() const {
    std::vector<Engine> engines;
    std::vector<JudgedEngine> judged;
    for (const char* name : {"a", "b", "c", "d"}) {
      EngineInfo info;
      info.name = info.laws.contact = name;
      engines.push_back({info, [](const WorldSpec&) { return std::unique_ptr<PhysicsBackend>(); }});
      judged.push_back({name, name, name});
    }
    Behaviour behaviour;
    behaviour.name = "made up";
    behaviour.statistics = {{"distance_m", "distance", "m", {0.05, 0, false, ""}},
                            {"height_m", "height", "m", {0.05, 0, false, ""}}};
    behaviour.seconds = 5;
    behaviour.physics_dt = 1e-3;
    behaviour.control_dt = behaviour.cut_dt = 4e-3;
    behaviour.run = [this](const Engine& engine, const Variation& variation, std::size_t start, double) {
      const auto which = static_cast<std::size_t>(engine.name().front() - 'a');
      Random shared(derived_seed(seed, start)), own(derived_seed(derived_seed(seed, 1000 + which), start));
      BehaviourRun run{{}, Outcome::kWalked, 5};
      for (int s = 0; s < 2; ++s)
        run.values.emplace_back(1 + 0.1 * shared.uniform(-1, 1) + 0.02 * own.uniform(-1, 1) +
                                0.001 * variation.step);
      if (which == faulty) *run.values[0] += fault;
      return run;
    };
    return crossgait::find_consensus(judged, reach_verdicts(behaviour, engines, {.starts = 16}).pairs);
  }
};

TEST(PlantedOutliers, AreNamedTwentyTimesOfTwenty) {
  int named = 0;
  for (std::uint64_t seed = 0; seed < 20; ++seed) {
    const Planted planted{seed, seed % 4, seed % 3 == 0 ? -0.5 : 0.5};
    const Consensus s = planted.stand();
    EXPECT_EQ(s.outlier, Indices{planted.faulty}) << s.reason;
    if (s.outlier != Indices{planted.faulty}) continue;
    ++named;
    EXPECT_EQ(s.statistics, std::vector<std::string>{"distance"});
  }
  EXPECT_EQ(named, 20);
}

TEST(PlantedOutliers, AreNotSeenWhereThereAreNone) {
  int alarms = 0;
  for (std::uint64_t seed = 0; seed < 100; ++seed) {
    const Consensus s = Planted{100 + seed, 0, 0}.stand();
    alarms += s.outlier.empty() ? 0 : 1;
    EXPECT_EQ(s.clusters.front().size(), 4U) << seed;
  }
  EXPECT_EQ(alarms, 0);
}

// Nothing that an engine does not do is held against it: what all share moves all.
TEST(PlantedOutliers, AreNotNamedOfAFaultWithinTheSpread) {
  for (std::uint64_t seed = 0; seed < 20; ++seed)
    EXPECT_TRUE((Planted{200 + seed, 1, 0.02}.stand().outlier.empty()));
}

TEST(ReachVerdicts, OfMoreEnginesAreNoSurerThanOfTwo) {
  // The same runs, judged with two others: the same means, wider intervals.
  Behaviour behaviour;
  behaviour.name = "made up";
  behaviour.statistics = {{"distance_m", "distance", "m", {0.02, 0.005, false, ""}}};
  behaviour.seconds = 5;
  behaviour.physics_dt = behaviour.control_dt = behaviour.cut_dt = 1e-3;
  std::map<std::string, int> runs;
  behaviour.run = [&runs](const Engine& engine, const Variation&, std::size_t start, double) {
    ++runs[engine.name()];
    Random own(derived_seed(static_cast<std::uint64_t>(engine.name().front()), start));
    return BehaviourRun{{1 + 0.1 * own.uniform(-1, 1)}, Outcome::kWalked, 5};
  };
  std::vector<Engine> engines;
  for (const char* name : {"a", "b", "c"}) {
    EngineInfo info;
    info.name = name;
    engines.push_back({info, [](const WorldSpec&) { return std::unique_ptr<PhysicsBackend>(); }});
  }
  const Verdict two = reach_verdicts(behaviour, std::span(engines).first(2), {}).pairs.front();
  const int once = runs["a"];
  runs.clear();
  const std::vector<Verdict> all = reach_verdicts(behaviour, engines, {}).pairs;
  ASSERT_EQ(all.size(), 3U);
  EXPECT_EQ(all[0].a + all[0].b + all[1].a + all[1].b + all[2].a + all[2].b, "abacbc");
  for (const auto& [name, count] : runs) EXPECT_EQ(count, once) << name;  // none is run twice
  EXPECT_EQ(all[0].statistics[0].gap.estimate, two.statistics[0].gap.estimate);
  EXPECT_LT(all[0].statistics[0].gap.low, two.statistics[0].gap.low);
  EXPECT_GT(all[0].statistics[0].gap.high, two.statistics[0].gap.high);
}

}  // namespace
}  // namespace crossgait
