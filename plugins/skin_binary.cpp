#include "skin_binary.h"

#include "bond.h"
#include "dihedral.h"
#include "fix.h"
#include "lammps.h"
#include "library.h"
#include "pair.h"
#include "utils.h"

#include <dlfcn.h>
#include <link.h>

#include <string>

using namespace LAMMPS_NS;

// the version and update that CMake has found

static const std::string COMPILED = SKIN_LAMMPS;    // NOLINT

#ifdef MPI_STUBS
static const std::string MPI = "none";    // NOLINT
#elif defined(OPEN_MPI)
static const std::string MPI = "Open MPI";    // NOLINT
#else
static const std::string MPI = "MPICH";    // NOLINT
#endif

static const std::string UPDATE = " - Update ";    // NOLINT

static std::string refusal;

// a class without virtual functions of its own has as many as its base in the headers

template <class Base> struct __attribute__((visibility("default"))) SkinTable : Base {
  ~SkinTable() override;
};
template <class Base> SkinTable<Base>::~SkinTable() {}
template struct SkinTable<Pair>;
template struct SkinTable<Bond>;
template struct SkinTable<Dihedral>;
template struct SkinTable<Fix>;

/* ----------------------------------------------------------------------
   size of the table of virtual functions of a class, or 0 if it cannot be found
------------------------------------------------------------------------- */

static size_t table_size(void *handle, const std::string &mangled)
{
  Dl_info info;
  const ElfW(Sym) *symbol = nullptr;
  void *const table = dlsym(handle, ("_ZTV" + mangled).c_str());
  if (!table || !dladdr1(table, &info, (void **) &symbol, RTLD_DL_SYMENT) || !symbol) return 0;
  return symbol->st_size;
}

/* ----------------------------------------------------------------------
   version and update of this LAMMPS: a build from a release's tag in git knows its update
------------------------------------------------------------------------- */

static std::string running_version(const LAMMPS *lmp)
{
  std::string tag = LAMMPS::has_git_info() ? LAMMPS::git_descriptor() : "";
  if (const size_t end = tag.find("-modified"); end != std::string::npos) tag.resize(end);
  if (utils::strmatch(tag, "^stable_\\w+_update\\d+$"))
    return lmp->version + UPDATE + tag.substr(tag.rfind("update") + 6);
  if (utils::strmatch(tag, "^stable_\\w+$")) return lmp->version + UPDATE + "0";
  return lmp->version;
}

/* ----------------------------------------------------------------------
   the MPI library of this LAMMPS; those with the binary interface of MPICH are called so
------------------------------------------------------------------------- */

static std::string running_mpi()
{
  if (!lammps_config_has_mpi_support()) return "none";
#ifdef MPI_STUBS
  return "another one";
#else
  char text[MPI_MAX_LIBRARY_VERSION_STRING];
  int length;
  MPI_Get_library_version(text, &length);
  return utils::strmatch(text, "^Open MPI") ? "Open MPI" : "MPICH";
#endif
}

/* ----------------------------------------------------------------------
   what the plugin was compiled for and what it finds; a LAMMPS that does not know its update is
   compared by the rest
------------------------------------------------------------------------- */

bool skin_fits(LAMMPS *lmp, void *handle)
{
  struct Item {
    std::string what, compiled, running;
  };
  const std::string version = running_version(lmp);
  const auto told = [](const std::string &text) { return text.find(UPDATE) != std::string::npos; };
  const bool updates = told(version) && told(COMPILED);
  std::vector<Item> items = {
      {"LAMMPS version", updates ? COMPILED : COMPILED.substr(0, COMPILED.find(" - ")),
       updates ? version : lmp->version},
      {"MPI", MPI, running_mpi()},
  };
  const auto compare = [&](const std::string &what, size_t mine, size_t running) {
    if (mine && running) items.push_back({what, std::to_string(mine), std::to_string(running)});
  };
  compare("sizeof(bigint)", sizeof(bigint), lammps_extract_setting(lmp, "bigint"));
  compare("sizeof(tagint)", sizeof(tagint), lammps_extract_setting(lmp, "tagint"));
  compare("sizeof(imageint)", sizeof(imageint), lammps_extract_setting(lmp, "imageint"));
  for (const std::string name : {"4Pair", "4Bond", "8Dihedral", "3Fix"}) {
    const std::string mangled = "N9LAMMPS_NS" + name + "E";
    compare("virtual functions in bytes, class " + name.substr(1) + ":",
            table_size(handle, "9SkinTableI" + mangled + "E"), table_size(RTLD_DEFAULT, mangled));
  }

  refusal.clear();
  for (const Item &item : items) {
    if (item.compiled == item.running) continue;
    refusal = "lammps-skin is not loaded: its plugin is compiled for " + item.what + " " +
        item.compiled + ", but this LAMMPS has " + item.running +
        ": install the LAMMPS that it is compiled for, or compile it for this one";
    if (lammps_extract_setting(lmp, "world_rank") == 0) utils::logmesg(lmp, refusal + "\n");
    return false;
  }
  return true;
}

/* ---------------------------------------------------------------------- */

const char *skin_refusal()
{
  return refusal.c_str();
}
