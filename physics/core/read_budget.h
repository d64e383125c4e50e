// What a file may cost to read: one budget for every reader, checked before anything is made of the file.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>

namespace crossgait {

/// Limits files: beyond any of these a reader refuses one by a ConfigError naming it. They are chosen so that
/// the worst file within them is read, or refused, in about a second and in less than 200 MB of memory, and
/// lie an order of magnitude above the largest file that Crossgait itself writes or brings along.
struct ReadBudget {
  std::size_t bytes = 0;   ///< size of the file
  std::size_t values = 0;  ///< values, elements or cells in it; aliases of YAML count as what they stand for
  int depth = 1;           ///< of values inside values
};

inline constexpr std::size_t kMebibyte = std::size_t{1} << 20U;

/// Robots, environments, described policies. A timetable of 10,000 steps has 50,000 values in 600 kB.
inline constexpr ReadBudget kYamlBudget{kMebibyte, 100'000, 32};
/// A link and its joint are some 20 elements, so these are 1,000 links; other programs' elements nest deeper
/// than URDF's own six levels.
inline constexpr ReadBudget kUrdfBudget{4 * kMebibyte, 20'000, 32};
/// What xacro may take for one file: robots of several hundred macros take 1 s, beside other work a few.
inline constexpr int kXacroSeconds = 30;
/// Links of a URDF or an SDF, most of them fixed to one of at most kMaxJoints + 1 bodies: chains are followed
/// by recursion, urdfdom's as ours.
inline constexpr std::size_t kMaxUrdfLinks = 1000;
/// Bytes of the name of a link or a joint, which is repeated for everything in it.
inline constexpr std::size_t kMaxUrdfName = 1000;
/// MJCF with everything that it includes: a body with its joint and shapes is some ten elements, so these are
/// 600; bodies nest as deep as chains have links. MuJoCo's compiler takes longer than its text is long.
inline constexpr ReadBudget kMjcfBudget{4 * kMebibyte, 6'000, 64};
inline constexpr std::size_t kMaxMjcfFiles = 100;
/// SDF with everything that it includes, as often as it does: numbers are elements there, so that a link and
/// its joint are some 40, and these are 1,000 links.
inline constexpr ReadBudget kSdfBudget{4 * kMebibyte, 40'000, 32};
inline constexpr std::size_t kMaxSdfFiles = 100;
/// Attributes of one element of XML, which TinyXML compares one by one with every further one.
inline constexpr std::size_t kMaxXmlAttributes = 100;
/// Collision meshes: a binary STL of 600,000 triangles, each with three vertices of 24 bytes in memory.
inline constexpr ReadBudget kMeshBudget{32 * kMebibyte, 2'000'000, 1};
/// The elements of a COLLADA mesh, most of which are its scene; its numbers are text.
inline constexpr ReadBudget kDaeBudget{kMeshBudget.bytes, 100'000, 32};
/// Bounds all meshes of a robot together: their files, and vertices that differ within a mesh, which are kept
/// for every use of it.
inline constexpr std::size_t kMaxRobotMeshBytes = 2 * kMeshBudget.bytes;
inline constexpr std::size_t kMaxRobotMeshVertices = 1'000'000;
/// Meshes of a robot that differ in a vertex or in their scale, to each of which a shape is fitted: a hull of
/// 200 corners takes up to a millisecond.
inline constexpr std::size_t kMaxFittedMeshes = 1000;
/// Results of `crossgait bench`: 1,100 values in 35 kB. Here and below the number of values is also that of
/// the keys of one object, which JSON in order of insertion compares one by one with every new key.
inline constexpr ReadBudget kJsonBudget{kMebibyte, 10'000, 32};
/// Results of any command, to be made again: 2,000 episodes have 130,000 values in 5 MB.
inline constexpr ReadBudget kResultBudget{8 * kMebibyte, 300'000, 32};
/// Policy bundles: a network of three layers of 1,000 takes 8 MiB; in memory every number of 4 bytes is also
/// once of 8.
inline constexpr ReadBudget kPolicyBudget{16 * kMebibyte, 5'000, 8};
/// Networks as ONNX files: those of published policies take 0.3 to 20 MiB.
inline constexpr ReadBudget kNetworkBudget{64 * kMebibyte, 1, 1};
/// The JSON in front of a bundle's numbers, which names observations and tensors.
inline constexpr std::size_t kMaxPolicyHeader = kMebibyte;
/// Pairs of a bundle's own test, each of which runs the network when it is read; Crossgait writes 8.
inline constexpr std::size_t kMaxGoldenPairs = 256;
/// One line of a run store: a run is 3 kB with some 100 values. Stores are read line by line
/// (`study/run_index.h`).
inline constexpr ReadBudget kRunBudget{kMebibyte, 5'000, 16};
/// Traces: four minutes of the bundled robot at 2 ms; values as doubles beside the text.
inline constexpr ReadBudget kTraceBudget{64 * kMebibyte, 8'000'000, 1};
/// Columns of a trace, which are found by name; `crossgait walk` writes some 70.
inline constexpr std::size_t kMaxTraceColumns = 4096;
/// Terrain tables: 16 bytes for each of kMaxHeightSamples would be 256 MiB; tables beyond this belong in a
/// PNG.
inline constexpr ReadBudget kTerrainTableBudget{64 * kMebibyte, std::size_t{1} << 24U, 1};
/// Terrain pictures: grey of 16 bit, uncompressed, of kMaxHeightSamples pixels is 32 MiB. Colour unfolds to
/// three times that.
inline constexpr ReadBudget kPictureBudget{48 * kMebibyte, std::size_t{1} << 24U, 1};

/// Says a size as "64 MiB", "20 bytes".
std::string size_in_words(std::size_t bytes);

/// Counts the values and levels of a JSON text without making anything of it; text that is no JSON is the
/// parser's to refuse, but for bytes of zero, behind which no parser looks. @param line  number of the text's
/// first line in its file
/// @throws ConfigError naming `source` and the line
void check_json_budget(std::string_view text, const ReadBudget& budget, const std::string& source,
                       int line = 1);

/// Checks the elements of an XML text, and their attributes, likewise. @throws ConfigError naming `source`
/// and the line
void check_xml_budget(std::string_view text, const ReadBudget& budget, const std::string& source);

}  // namespace crossgait
