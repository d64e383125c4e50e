// Plug-ins that are used and plug-ins that are refused, made by plugins/CMakeLists.txt.
#include <algorithm>
#include <cfenv>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <functional>
#include <thread>

#include <dlfcn.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include "backends/plugin_loader.h"
#include "backends/registry.h"
#include "physics/core/error.h"
#include "tests/physics/core/scratch_folder.h"
#include "tests/support/engine_test.h"

namespace crossgait {
namespace {

namespace fs = std::filesystem;

std::string built(const std::string& name) {
  return std::string(CROSSGAIT_TEST_PLUGINS) + "/libcrossgait_engine_" + name + ".so";
}

const EngineListing* listing(const EngineRegistry& registry, const std::string& name,
                             const std::string& file) {
  for (const EngineListing& entry : registry.listings()) {
    if (entry.name == name && entry.file == file) return &entry;
  }
  return nullptr;
}

class Plugin : public ScratchFolder {
 protected:
  void SetUp() override {
    ScratchFolder::SetUp();
    folder_ = fs::canonical(folder_);  // registries resolve links
  }
  void TearDown() override {
    unsetenv("CROSSGAIT_TEST_FAULT");
    unsetenv("CROSSGAIT_ENGINE_PATH");
    ScratchFolder::TearDown();
  }

  /// A copy that has not been opened before, so that it can go wrong in a way of its own.
  std::string copy(const std::string& name, const std::string& as) const {
    std::string file = path("libcrossgait_engine_" + as + ".so");
    fs::copy_file(built(name), file, fs::copy_options::overwrite_existing);
    return file;
  }
  std::string refusal(const std::string& fault) const {
    setenv("CROSSGAIT_TEST_FAULT", fault.c_str(), 1);
    const LoadedPlugin loaded = load_plugin(copy("test_1", "fault"));
    EXPECT_EQ(loaded.plugin, nullptr) << fault;
    return loaded.reason;
  }
};

#define EXPECT_CONTAINS(text, part) EXPECT_NE((text).find(part), std::string::npos) << (text)

TEST_F(Plugin, IsRefusedIfItsInterfaceIsAnother) {
  const std::string reason = refusal("interface");
  EXPECT_CONTAINS(reason,
                  "version " + std::to_string(kPluginInterfaceVersion + 1) + " of the plug-in interface");
}

TEST_F(Plugin, IsRefusedIfItWasBuiltDifferently) {
  const std::string size = std::to_string(sizeof(WorldSpec));
  const std::string reason = refusal("stamp");
  // What differs, and nothing else.
  EXPECT_CONTAINS(reason, "(sizeof WorldSpec 9" + size + " instead of sizeof WorldSpec " + size + ")");
}

TEST_F(Plugin, IsRefusedIfItsStampIsOfAnotherKind) {
  EXPECT_CONTAINS(refusal("other compiler"), "\"cc 1; \" instead of");
}

TEST_F(Plugin, IsRefusedIfItFoundAnotherLibraryThanItsHeaders) {
  EXPECT_CONTAINS(refusal("headers"), "headers of version 2.3.7, but the library it found is 1");
}

TEST_F(Plugin, IsRefusedIfItIsIncomplete) { EXPECT_CONTAINS(refusal("function"), "leaves out a function"); }

TEST_F(Plugin, IsRefusedIfItOffersNothing) {
  EXPECT_CONTAINS(refusal("nothing offered"), "offers no engine");
}

TEST_F(Plugin, IsRefusedIfItGivesNothing) { EXPECT_CONTAINS(refusal("null"), "gives nothing"); }

TEST_F(Plugin, IsRefusedWithItsOwnWordsIfItThrows) { EXPECT_EQ(refusal("throw"), "no licence"); }

TEST_F(Plugin, IsRefusedIfItThrowsAnything) {
  EXPECT_CONTAINS(refusal("throw a number"), "no exception of the standard library");
}

// The system's loader maps what the header names, and touching what is not there ends the process.
TEST_F(Plugin, IsRefusedIfItIsCutOff) {
  const std::uintmax_t whole = fs::file_size(built("test_1"));
  for (const std::uintmax_t kept : {std::uintmax_t{70}, whole / 10, whole / 2}) {
    const std::string file = copy("test_1", "cut");
    fs::resize_file(file, kept);
    const LoadedPlugin loaded = load_plugin(file);
    EXPECT_EQ(loaded.plugin, nullptr);
    EXPECT_EQ(loaded.reason, "it is cut off: it has " + std::to_string(kept) + " bytes, and names more");
  }
}

// What code does when it is opened, it does to a fork of the program.
TEST_F(Plugin, IsRefusedForWhatItDoesWhenItIsOpened) {
  const std::string file = copy("constructor", "constructor");
  constexpr std::chrono::milliseconds kShort{500};
  const auto reason = [&](const char* fault, std::chrono::milliseconds limit = kTrialLimit) {
    setenv("CROSSGAIT_TEST_FAULT", fault, 1);
    const LoadedPlugin loaded = load_plugin(file, limit);
    EXPECT_EQ(loaded.plugin, nullptr) << fault;
    return loaded.reason;
  };
  EXPECT_EQ(reason("exit"), "it ended the process in which it was tried");
  EXPECT_EQ(reason("_exit"), "it ended the process in which it was tried");
  EXPECT_EQ(reason("abort"), "signal 6 (Aborted) ended the process in which it was tried");
  EXPECT_EQ(reason("throw"), "signal 6 (Aborted) ended the process in which it was tried");
  EXPECT_EQ(reason("wait", kShort), "it was not opened within 0.5 s when it was tried");
  EXPECT_EQ(reason("stop", kShort), "it was not opened within 0.5 s when it was tried");
  EXPECT_CONTAINS(reason("nothing"), "gives nothing");  // it was opened there, and only there
  EXPECT_EQ(dlopen(file.c_str(), RTLD_LAZY | RTLD_NOLOAD), nullptr) << "what is refused is not opened here";
}

TEST_F(Plugin, IsRefusedIfItChangesTheProcess) {
  const auto with = [](const std::function<void()>& change) {
    return try_in_fork([&] { return change(), std::string(); });
  };
  EXPECT_EQ(with([] {}), "");
  EXPECT_CONTAINS(with([] { ::feenableexcept(FE_DIVBYZERO); }), "changes how the whole program computes");
  EXPECT_CONTAINS(with([] { std::fesetround(FE_UPWARD); }), "changes how the whole program computes");
  EXPECT_CONTAINS(with([] { ::close(STDOUT_FILENO); }), "closes a standard stream");
}

TEST_F(Plugin, IsWaitedForNoLongerThanTheLimit) {
  const auto wait = [] {
    while (true) ::pause();
    return std::string();
  };
  // Whatever part of a millisecond is left when the system's wait ends.
  for (int i = 1; i <= 40; ++i)
    EXPECT_CONTAINS(try_in_fork(wait, std::chrono::milliseconds(i)), "it was not opened within 0.0") << i;
  const auto close_and_wait = [&] {
    ::close_range(3, ~0U, 0);  // and what it was to answer on
    return wait();
  };
  EXPECT_CONTAINS(try_in_fork(close_and_wait, std::chrono::milliseconds(200)), "within 0.2 s");
}

// As a copy leaves them that was stopped: of the right size, with holes; or with a bit that turned.
TEST_F(Plugin, IsRefusedOrUsedButEndsNothingIfItIsDamaged) {
  const std::string whole = read(built("test_1"));
  constexpr std::size_t kParts = 24;
  std::size_t refused = 0;
  for (std::size_t i = 0; i < kParts; ++i) {
    std::string holed = whole, turned = whole;
    const std::size_t begin = std::max<std::size_t>(4096, i * whole.size() / kParts);
    std::fill_n(holed.begin() + static_cast<std::ptrdiff_t>(begin),
                std::min(whole.size() - begin, whole.size() / kParts), '\0');
    turned[i * whole.size() / kParts + 100] ^= 0x40;
    for (const std::string& bytes : {holed, turned}) {
      const std::string name =
          "libcrossgait_engine_damaged" + std::to_string(i) + (bytes == holed ? "h.so" : "t.so");
      std::ofstream(path(name), std::ios::binary) << bytes;
      // In a process of its own: what was damaged and is used all the same is not to stay in this one.
      const pid_t child = ::fork();
      if (child == 0) ::_exit(load_plugin(path(name)).reason.empty() ? 0 : 3);
      int status = 0;
      ASSERT_EQ(::waitpid(child, &status, 0), child);
      EXPECT_TRUE(WIFEXITED(status)) << name;
      refused += WEXITSTATUS(status) == 3 ? 1 : 0;
    }
  }
  EXPECT_GT(refused, 1U);
}

TEST_F(Plugin, IsRefusedIfItIsNoFile) {
  ASSERT_EQ(::mkfifo(path("libcrossgait_engine_pipe.so").c_str(), 0600), 0);
  fs::create_directory(path("libcrossgait_engine_folder.so"));
  fs::create_symlink("/dev/zero", path("libcrossgait_engine_device.so"));
  for (const std::string& file : plugin_files({folder_.string()}))
    EXPECT_EQ(load_plugin(file).reason, "it is no regular file") << file;
}

TEST_F(Plugin, IsRefusedWithoutItsFunction) {
  EXPECT_CONTAINS(load_plugin(built("no_function")).reason, "no function crossgait_engine_plugin");
}

TEST_F(Plugin, IsRefusedWithASymbolMissing) {
  EXPECT_CONTAINS(load_plugin(built("unresolved")).reason,
                  "undefined symbol: function_of_a_library_that_is_not_there");
}

TEST_F(Plugin, IsRefusedIfItIsNoLibrary) {
  const std::string text(1000, 'x');
  EXPECT_EQ(load_plugin(write("libcrossgait_engine_text.so", text)).reason, "invalid ELF header");
  EXPECT_EQ(load_plugin(write("libcrossgait_engine_empty.so", "")).reason, "file too short");
  EXPECT_EQ(load_plugin(path("nothing.so")).reason, "No such file or directory");
}

TEST_F(Plugin, ExportsItsFunctionAlone) {
  for (const char* name : {"test_1", "test_2"}) {
    void* library = dlopen(built(name).c_str(), RTLD_NOW | RTLD_LOCAL);
    ASSERT_NE(library, nullptr) << dlerror();
    EXPECT_NE(dlsym(library, kPluginFunction), nullptr);
    // Crossgait's own code, a template of the standard library, the engine's: each is in the file.
    for (const char* symbol :
         {"_ZN9crossgait14PhysicsBackend5resetERKNS_10RobotStateE", "_ZTVN9crossgait14PhysicsBackendE",
          "_ZTIN9crossgait11ConfigErrorE",
          "_ZN6statue6engineERKNSt7__cxx1112basic_stringIcSt11char_traitsIcESaIcEEES7_"}) {
      EXPECT_EQ(dlsym(library, symbol), nullptr) << name << ": " << symbol;
    }
  }
}

TEST_F(Plugin, TwoVersionsOfALibraryLiveTogether) {
  const EngineRegistry registry({CROSSGAIT_TEST_PLUGINS});
  const WorldSpec spec = scenes::world_of(scenes::sled());
  const Engine first = registry.find("stone@1"), second = registry.find("stone@2");
  EXPECT_EQ(first.info.version, "1");
  EXPECT_EQ(second.info.version, "2");
  // Functions and variables of one name are those of the plug-in's own library.
  const auto made = [&](const char* name) { return std::stoi(registry.find(name).info.mode); };
  const int first_before = made("stone@1"), second_before = made("stone@2");
  EXPECT_EQ(first.make(spec)->info().name, "stone@1");
  EXPECT_EQ(first.make(spec)->info().name, "stone@1");
  EXPECT_EQ(second.make(spec)->info().name, "stone@2");
  EXPECT_EQ(made("stone@1"), first_before + 2);
  EXPECT_EQ(made("stone@2"), second_before + 1);
}

TEST_F(Plugin, TheNewestThatCanReadsMjcf) {
  const EngineRegistry registry({CROSSGAIT_TEST_PLUGINS});
  EXPECT_TRUE(registry.compiles_mjcf());
  EXPECT_EQ(registry.compile_mjcf({"robot.xml", "this", {}}).name, "this by stone@2");
}

TEST_F(Plugin, WorksAcrossTheBoundary) {
  const EngineRegistry registry({CROSSGAIT_TEST_PLUGINS});
  const auto world = registry.find("stone@1").make(scenes::world_of(scenes::quadruped()));
  EXPECT_EQ(world->step(scenes::home_targets(world->robot()), 10), StepStatus::kOk);
  EXPECT_NEAR(world->state().time, 0.01, 1e-15);
  const Snapshot snapshot = world->save();
  RobotState elsewhere = world->state();
  elsewhere.p_WB.x() += 1;
  world->reset(elsewhere);
  world->restore(snapshot);
  EXPECT_EQ(world->state().p_WB, snapshot.state.p_WB);
  // Exceptions thrown there are caught here: by the plug-in itself, and by Crossgait's code inside it.
  EXPECT_THROW(registry.find("stone@1+factor"), ConfigError);
  EXPECT_THROW(world->restore({}), ConfigError);
  WorldSpec bad = world->spec();
  bad.physics_dt = -1;
  EXPECT_THROW(registry.find("stone@1").make(bad), ConfigError);
}

TEST_F(Plugin, OutlivesTheRegistryThatOpenedIt) {
  std::unique_ptr<PhysicsBackend> world;
  Engine engine;
  {
    const EngineRegistry registry({CROSSGAIT_TEST_PLUGINS});
    engine = registry.find("stone@2");
    world = engine.make(scenes::world_of(scenes::sled()));
  }
  EXPECT_EQ(world->step({}, 3), StepStatus::kOk);
  EXPECT_EQ(engine.make(world->spec())->info().version, "2");
}

TEST_F(Plugin, OfANameTheFirstFoundHasIt) {
  const EngineRegistry registry({CROSSGAIT_TEST_PLUGINS});
  EXPECT_EQ(registry.find("stone").info.version, "1");
  const EngineListing* second = listing(registry, "stone", fs::canonical(built("test_2")));
  ASSERT_NE(second, nullptr);
  EXPECT_FALSE(second->available);
  EXPECT_EQ(second->reason, "already offered by " + fs::canonical(built("test_1")).string());
  EXPECT_EQ(second->info.version, "2");

  // Folders count before names of files.
  const std::string other = copy("test_2", "zzz");
  const EngineRegistry reversed({folder_.string(), CROSSGAIT_TEST_PLUGINS});
  EXPECT_EQ(reversed.find("stone").info.version, "2");
  EXPECT_FALSE(listing(reversed, "stone@2", fs::canonical(built("test_2")))->available);
  EXPECT_TRUE(listing(reversed, "stone@2", other)->available);
}

TEST_F(Plugin, OneFileIsOpenedOnce) {
  fs::create_symlink(built("test_1"), path("libcrossgait_engine_link.so"));
  const std::vector<std::string> files =
      plugin_files({folder_.string(), CROSSGAIT_TEST_PLUGINS, CROSSGAIT_TEST_PLUGINS, path("nowhere")});
  EXPECT_EQ(std::count(files.begin(), files.end(), fs::canonical(built("test_1")).string()), 1);
  EXPECT_EQ(files.size(), 5U);  // test_1, test_2, no_function, unresolved, constructor
  EXPECT_EQ(plugin_name(files.front()), "test_1");
}

TEST_F(Plugin, ALinkToNothingIsAFileThatSaysSo) {
  const std::string link = path("libcrossgait_engine_dangling.so");
  fs::create_symlink(path("nothing.so"), link);
  EXPECT_EQ(plugin_files({folder_.string()}), std::vector<std::string>{link});
  EXPECT_EQ(load_plugin(link).reason, "No such file or directory");
}

TEST_F(Plugin, RefusedOnesAreListedAndSayWhy) {
  write("libcrossgait_engine_broken.so", "");
  write("libcrossgait_engine_bullet.so", "");  // the name of one that comes with Crossgait
  write("engine.so", "");                      // not of that kind
  const EngineRegistry registry({folder_.string()});
  EXPECT_TRUE(registry.available().empty());
  for (const char* name : {"bullet", "bullet:matched"}) {
    const EngineListing* entry = listing(registry, name, path("libcrossgait_engine_bullet.so"));
    ASSERT_NE(entry, nullptr) << name;
    EXPECT_EQ(entry->reason, "file too short");
  }
  try {
    registry.find("broken+more");
    ADD_FAILURE();
  } catch (const ConfigError& error) {
    EXPECT_EQ(error.found(), "file too short");
  }
}

TEST_F(Plugin, WhatComesWithCrossgaitIsListedWhereItIsNotFound) {
  const EngineRegistry registry({folder_.string()});
  for (const char* name : {"mujoco", "bullet", "bullet:matched"}) {
    const EngineListing* entry = listing(registry, name, "");
    ASSERT_NE(entry, nullptr) << name;
    EXPECT_FALSE(entry->available);
    // Which of the three depends on the build.
    EXPECT_TRUE(entry->reason.find("is in none of " + folder_.string()) != std::string::npos ||
                entry->reason.find("was switched off") != std::string::npos ||
                entry->reason.find("was not found when Crossgait was built (Debian: lib") !=
                    std::string::npos)
        << entry->reason;
  }
}

TEST_F(Plugin, FoldersAreThoseOfTheVariableAndTheRunPath) {
  unsetenv("CROSSGAIT_ENGINE_PATH");
  const std::vector<std::string> own = plugin_folders();
  EXPECT_FALSE(own.empty());
  // The run path of a build has empty entries, which the system takes for wherever the program is started.
  for (const std::string& folder : own) EXPECT_TRUE(folder.starts_with('/')) << "'" << folder << "'";
  setenv("CROSSGAIT_ENGINE_PATH", (":" + folder_.string() + "::.:" + CROSSGAIT_TEST_PLUGINS).c_str(), 1);
  const std::vector<std::string> all = plugin_folders();
  ASSERT_EQ(all.size(), own.size() + 3);
  EXPECT_EQ(all[0], folder_.string());
  EXPECT_EQ(all[1], ".");
  EXPECT_EQ(all[2], CROSSGAIT_TEST_PLUGINS);
  setenv("CROSSGAIT_ENGINE_PATH", (folder_.string() + ":" + path("nowhere")).c_str(), 1);
  try {
    plugin_folders();
    ADD_FAILURE();
  } catch (const ConfigError& error) {
    EXPECT_EQ(error.element(), "CROSSGAIT_ENGINE_PATH");
    EXPECT_CONTAINS(error.found(), path("nowhere"));
  }
}

TEST_F(Plugin, FirstUseMayBeFromManyThreads) {
  const std::string file = copy("test_1", "shared");
  std::vector<std::string> reasons(8, "none was found");
  std::vector<std::thread> threads;
  threads.reserve(reasons.size());
  for (std::string& reason : reasons) {
    threads.emplace_back([&] {
      const EngineRegistry registry({folder_.string()});
      for (const EngineListing& entry : registry.listings())
        if (entry.file == file) reason = entry.reason;
      if (reason.empty()) registry.find("stone@1").make(scenes::world_of(scenes::sled()));
    });
  }
  for (std::thread& thread : threads) thread.join();
  for (const std::string& reason : reasons) EXPECT_EQ(reason, "");
}

TEST_F(Plugin, OfAnEngineSaysItsVersionAsTheEngineDoes) {
  for (const EngineListing& entry : known_engines()) {
    if (!entry.available) continue;
    const LoadedPlugin loaded = load_plugin(entry.file);
    ASSERT_NE(loaded.plugin, nullptr) << loaded.reason;
    EXPECT_EQ(loaded.plugin->header_version(), entry.info.version) << entry.name;
    EXPECT_EQ(loaded.plugin->library_version(), entry.info.version) << entry.name;
  }
}

}  // namespace
}  // namespace crossgait
