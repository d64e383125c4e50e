#include "physics/core/files_read.h"

#include <thread>

#include "physics/core/sha256.h"
#include "physics/core/text.h"
#include "tests/physics/core/scratch_folder.h"

namespace crossgait {
namespace {

class FilesOfAThread : public ScratchFolder {
 protected:
  static void read_file(const std::string& file) { (void)read_text_file(file, kYamlBudget); }
  static std::vector<std::string> names(const FilesRead& files) {
    std::vector<std::string> result;
    for (const FileRead& file : files.list()) result.push_back(file.path);
    return result;
  }
};

TEST_F(FilesOfAThread, AreThoseThatWereReadWithTheirBytes) {
  const std::string a = write("a", "abc"), b = write("b", "");
  EXPECT_EQ(FilesRead::current(), nullptr);
  read_file(a);  // by nobody who asks
  const FilesRead files;
  EXPECT_EQ(FilesRead::current(), &files);
  for (const std::string& file : {b, a, b}) read_file(file);
  EXPECT_EQ(files.list(), (std::vector<FileRead>{{b, sha256_hex("")}, {a, sha256_hex("abc")}}));
  EXPECT_EQ(file_sha256(a), "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad");
  EXPECT_ANY_THROW(read_file(path("none")));
  EXPECT_EQ(files.list().size(), 2U);
}

TEST_F(FilesOfAThread, StandTwiceWhereTheyChangedMeanwhile) {
  const FilesRead files;
  const std::string a = write("a", "1");
  read_file(a);
  write("a", "2");
  read_file(a);
  EXPECT_EQ(files.list(), (std::vector<FileRead>{{a, sha256_hex("1")}, {a, sha256_hex("2")}}));
}

TEST_F(FilesOfAThread, AreHandedOnUnlessTheyStandApart) {
  const std::string a = write("a", ""), b = write("b", ""), c = write("c", ""), d = write("d", "");
  const FilesRead outer;
  read_file(a);
  {
    const FilesRead inner;
    read_file(b);
    const FilesRead apart(FilesRead::Scope::kApart);
    read_file(c);
    EXPECT_EQ(names(apart), std::vector{c});
    EXPECT_EQ(names(inner), std::vector{b});
  }
  EXPECT_EQ(names(outer), (std::vector{a, b}));
  std::thread([&] { read_file(d); }).join();  // another thread's reading is another's
  EXPECT_EQ(names(outer), (std::vector{a, b}));
}

}  // namespace
}  // namespace crossgait
