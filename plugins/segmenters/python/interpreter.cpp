// SPDX-License-Identifier: BSD-3-Clause
#include "interpreter.hpp"

#include <dlfcn.h>

#include <atomic>
#include <cstdlib>
#include <filesystem>
#include <mutex>
#include <string>
#include <thread>

#include "holdfast/core/error.hpp"

namespace holdfast::python_plugin {

namespace {

std::mutex starting;
std::atomic<int> users = 0;
std::thread::id starter;  // of Python; to Python it is the main thread

void require(const PyStatus& status, const char* what) {
  if (PyStatus_Exception(status) == 0) return;
  throw Error(std::string("segmenter 'python': Python cannot ") + what + ": " +
              (status.err_msg != nullptr ? status.err_msg : "no reason given") +
              "; is Python's standard library installed, and do PYTHONHOME and VIRTUAL_ENV fit Python " + PY_VERSION +
              "?");
}

/// Extension modules such as numpy's look for Python's symbols among those of the program; with a plugin's own
/// libraries they would not be there.
void show_symbols_to_extensions() {
  Dl_info python = {};
  if (dladdr(reinterpret_cast<void*>(&Py_IsInitialized), &python) == 0 || python.dli_fname == nullptr) return;
  dlopen(python.dli_fname, RTLD_NOW | RTLD_GLOBAL | RTLD_NOLOAD);
}

class Configuration {
 public:
  Configuration() { PyConfig_InitPythonConfig(&config_); }
  ~Configuration() { PyConfig_Clear(&config_); }
  Configuration(const Configuration&) = delete;
  Configuration& operator=(const Configuration&) = delete;
  PyConfig& operator*() { return config_; }
  PyConfig* operator->() { return &config_; }

 private:
  PyConfig config_;
};

void end_python() {
  // With a segmenter alive, its destructor still comes: then Python stays.
  if (users > 0 || Py_IsInitialized() == 0) return;
  const PyGILState_STATE state = PyGILState_Ensure();
  if (std::this_thread::get_id() == starter) {
    Py_FinalizeEx();
    return;
  }
  // From another thread Python would wait for its main thread to end, which it never learns of. So only what users see
  // of the end is done, and the process takes the rest with it.
  PyRun_SimpleString("import atexit, sys\natexit._run_exitfuncs()\nsys.stdout.flush()\nsys.stderr.flush()");
  PyGILState_Release(state);
}

void start_python() {
  show_symbols_to_extensions();
  // The locale is the program's; text is UTF-8 whatever it is.
  PyPreConfig before;
  PyPreConfig_InitPythonConfig(&before);
  before.configure_locale = 0;
  before.coerce_c_locale = 0;
  before.utf8_mode = 1;
  require(Py_PreInitialize(&before), "be prepared");
  Configuration configuration;
  configuration->install_signal_handlers = 0;
  configuration->parse_argv = 0;
  configuration->write_bytecode = 0;  // nothing is left beside the user's file
  // In an activated virtual environment its packages count, as they would for `python3`.
  if (const char* environment = std::getenv("VIRTUAL_ENV")) {
    const std::string program = (std::filesystem::path(environment) / "bin" / "python3").string();
    require(PyConfig_SetBytesString(&*configuration, &configuration->program_name, program.c_str()),
            "take the program's name");
  }
  require(Py_InitializeFromConfig(&*configuration), "be started");
  starter = std::this_thread::get_id();
  PyEval_SaveThread();  // every call takes the lock anew, from whichever thread
  std::atexit(end_python);
}

}  // namespace

Interpreter::Interpreter() {
  const std::lock_guard lock(starting);
  if (Py_IsInitialized() == 0) start_python();
  ++users;
}

Interpreter::~Interpreter() { --users; }

}  // namespace holdfast::python_plugin
