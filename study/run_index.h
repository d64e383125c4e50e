// Where each run of a store is, so that a store of a million rows opens in a second.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <unordered_map>
#include <utility>
#include <vector>

#include "study/stored_row.h"

namespace crossgait {

/// Bounds a store: 1,000,000 runs of a study, and as many again; a run is 3 kB.
inline constexpr std::size_t kMaxStoredRuns = 4'000'000;
inline constexpr std::size_t kMaxStoreBytes = std::size_t{16} << 30U;
/// Stores from this size on get an index beside them; smaller ones are read in less time than it matters.
inline constexpr std::size_t kIndexedStoreBytes = std::size_t{16} << 20U;

/// Finds a store's runs by their hashes. Of rows of one hash the last that has a result counts.
///
/// It is kept in FILE.index beside the store FILE. An index that is missing, torn, of another file, or of a
/// store that was changed otherwise than by appending, is not used: the store is read from its beginning,
/// each row of it is checked, and the index is made anew. Of rows behind those that it knows, these alone are
/// read.
class RunIndex {
 public:
  enum class Begin { kFromIndex, kAnew };
  /// Reads the index, and what of the store it does not know, or all of the store. Changes no file.
  /// @throws ConfigError naming file and line for what is no stored run, or a store beyond the bounds above
  explicit RunIndex(std::string store, Begin begin = Begin::kFromIndex);

  /// Counts runs that have a result.
  std::size_t size() const noexcept { return size_; }
  /// Counts bytes of the store as it was read; of them, those of a last line that was cut off; and whether a
  /// last line is whole but for its end.
  std::size_t bytes() const noexcept { return bytes_; }
  std::size_t torn_bytes() const noexcept { return torn_bytes_; }
  bool lacks_line_end() const noexcept { return lacks_line_end_; }

  /// Reads the run from the store. @throws ConfigError if another row stands there: somebody changed the
  /// store
  std::optional<RunResult> find(std::uint64_t hash) const;
  /// Notes a row that was appended. @param begin  of its line, bytes from the beginning  @param end  behind
  /// its end  @param failed  whether its run did
  void add(std::uint64_t hash, std::size_t begin, std::size_t end, bool failed = false);

  /// Tells whether the run of a row failed; none where no row is of it.
  std::optional<bool> has_failed(std::uint64_t hash) const;

  /// Writes FILE.index if the store is large enough and enough of it is new, and no file of somebody else's
  /// is in the way. For whoever holds the store's lock. What cannot be written is not: it only saves time.
  void save(std::size_t least_bytes = kIndexedStoreBytes) noexcept;

 private:
  /// Says of a row where it begins, and whether its run failed.
  struct Place {
    std::uint64_t hash = 0, begin : 63 = 0, failed : 1 = 0;
  };
  struct Header;

  bool load();
  void scan();
  void add_line(std::string_view line, std::size_t begin);
  void put(const Place& place);
  void merge();
  const Place* place_of(std::uint64_t hash) const;

  std::string store_;
  std::vector<Place> places_;                        ///< by hash, each once
  std::unordered_map<std::uint64_t, Place> latest_;  ///< behind them, not merged yet
  std::size_t size_ = 0, rows_ = 0;
  std::size_t bytes_ = 0, torn_bytes_ = 0;
  std::size_t covered_ = 0,
              saved_ = 0;  ///< bytes of whole lines that are known, and that the file's index knows
  std::size_t next_ = 0;   ///< where the next row is to begin
  bool lacks_line_end_ = false, is_stale_ = false;
  bool knows_all_ = true;  ///< none was appended by somebody else
};

}  // namespace crossgait
