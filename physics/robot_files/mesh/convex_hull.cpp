#include "physics/robot_files/mesh/convex_hull.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <set>
#include <utility>

namespace crossgait {
namespace {

/// Of the points' extent: what counts as lying in a face's plane.
constexpr double kFlat = 1e-9;

class HullBuilder {
 public:
  HullBuilder(const std::vector<Vector3>& points, int most)
      : points_(points), most_(static_cast<std::size_t>(most)) {}

  ConvexHull build() {
    if (start()) {
      while (corners_.size() < most_ && grow()) {
      }
    }
    ConvexHull hull;
    for (const std::size_t i : corners_) hull.vertices.push_back(points_[i]);
    for (const Face& face : faces_) {
      const auto from_first = [&](int k) { return Vector3(corner(face, k) - points_[corners_[0]]); };
      hull.volume += from_first(0).dot(from_first(1).cross(from_first(2))) / 6;
      for (const std::size_t i : face.outside) hull.error = std::max(hull.error, face.height(points_[i]));
    }
    return hull;
  }

 private:
  struct Face {
    std::array<std::size_t, 3> corners;  ///< anticlockwise seen from outside
    Vector3 normal;
    double offset = 0;
    std::vector<std::size_t> outside;  ///< points that no earlier face has
    double highest = 0;                ///< of them
    double height(const Vector3& p) const { return normal.dot(p) - offset; }
  };

  const Vector3& corner(const Face& face, int k) const {
    return points_[face.corners[static_cast<std::size_t>(k)]];
  }

  /// Where `measure` is largest; of points that are equal to within `tie` the least by x, y and z, which is
  /// no mere point of an edge.
  template <typename Measure>
  std::size_t farthest(Measure measure, double tie = 0) const {
    double most = -std::numeric_limits<double>::infinity();
    for (const Vector3& p : points_) most = std::max(most, measure(p));
    std::size_t best = points_.size();
    for (std::size_t i = 0; i < points_.size(); ++i) {
      if (measure(points_[i]) >= most - tie) best = earlier(i, best);
    }
    return best;
  }

  std::size_t earlier(std::size_t i, std::size_t best) const {
    if (best == points_.size()) return i;
    const Vector3 &a = points_[i], &b = points_[best];
    return std::lexicographical_compare(a.begin(), a.end(), b.begin(), b.end()) ? i : best;
  }

  /// A tetrahedron. @returns false where the points have no volume; then `corners_` are those of the best
  /// attempt
  bool start() {
    const Vector3& a = points_[corners_.emplace_back(farthest([](const Vector3& p) { return -p.x(); }))];
    const Vector3& b =
        points_[corners_.emplace_back(farthest([&](const Vector3& p) { return (p - a).squaredNorm(); }))];
    flat_ = kFlat * (b - a).norm();
    const Vector3 along = (b - a).normalized();
    const Vector3& c = points_[corners_.emplace_back(
        farthest([&](const Vector3& p) { return (p - a).cross(along).squaredNorm(); }))];
    const Vector3 normal = along.cross(c - a).normalized();
    const Vector3& d = points_[corners_.emplace_back(
        farthest([&](const Vector3& p) { return std::abs(normal.dot(p - a)); }, flat_))];
    const double height = normal.dot(d - a);
    if (!(std::abs(height) > flat_) || !((c - a).cross(along).norm() > flat_)) return false;
    const auto [i, j, k, l] =
        std::array{corners_[0], corners_[height > 0 ? 2 : 1], corners_[height > 0 ? 1 : 2], corners_[3]};
    add_face(i, j, k);
    add_face(i, k, l);
    add_face(k, j, l);
    add_face(j, i, l);
    std::vector<std::size_t> all(points_.size());
    for (std::size_t n = 0; n < all.size(); ++n) all[n] = n;
    share_out(all, 0);
    return true;
  }

  void add_face(std::size_t i, std::size_t j, std::size_t k) {
    Face face{
        {i, j, k}, (points_[j] - points_[i]).cross(points_[k] - points_[i]).stableNormalized(), 0, {}, 0};
    face.offset = face.normal.dot(points_[i]);
    faces_.push_back(std::move(face));
  }

  /// Gives each point to the face, from `first` on, that it lies farthest outside of; those inside are
  /// forgotten.
  void share_out(const std::vector<std::size_t>& points, std::size_t first) {
    for (const std::size_t i : points) {
      Face* nearest = nullptr;
      double most = flat_;
      for (std::size_t f = first; f < faces_.size(); ++f) {
        const double height = faces_[f].height(points_[i]);
        if (height > most) {
          most = height;
          nearest = &faces_[f];
        }
      }
      if (nearest == nullptr) continue;
      nearest->outside.push_back(i);
      nearest->highest = std::max(nearest->highest, most);
    }
  }

  /// Adds the farthest point. @returns false if there is none
  bool grow() {
    double most = 0;
    for (const Face& face : faces_) most = std::max(most, face.highest);
    std::size_t apex = points_.size();
    for (const Face& face : faces_) {
      if (face.highest < most - flat_) continue;  // which spares looking at most points
      for (const std::size_t i : face.outside) {
        if (face.height(points_[i]) >= most - flat_) apex = earlier(i, apex);
      }
    }
    if (apex == points_.size()) return false;
    // Faces whose plane holds the apex go, too: they become part of larger ones.
    const auto seen = [&](const Face& face) { return face.height(points_[apex]) > -flat_; };
    const auto first_seen =
        std::stable_partition(faces_.begin(), faces_.end(), [&](const Face& f) { return !seen(f); });
    std::set<std::pair<std::size_t, std::size_t>> edges;
    std::vector<std::size_t> orphans;
    for (auto face = first_seen; face != faces_.end(); ++face) {
      for (std::size_t k = 0; k < 3; ++k) edges.emplace(face->corners[k], face->corners[(k + 1) % 3]);
      orphans.insert(orphans.end(), face->outside.begin(), face->outside.end());
    }
    faces_.erase(first_seen, faces_.end());
    const std::size_t first_new = faces_.size();
    for (const auto& [from, to] : edges) {
      if (edges.count({to, from}) == 0) add_face(from, to, apex);
    }
    share_out(orphans, first_new);
    corners_.push_back(apex);
    return true;
  }

  const std::vector<Vector3>& points_;
  std::size_t most_;
  double flat_ = 0;
  std::vector<std::size_t> corners_;
  std::vector<Face> faces_;
};

}  // namespace

ConvexHull convex_hull(const std::vector<Vector3>& points, int most) {
  return HullBuilder(points, most).build();
}

}  // namespace crossgait
