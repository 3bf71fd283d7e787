#include "skin_state_section.h"

#include "error.h"
#include "fix.h"
#include "input.h"
#include "modify.h"
#include "platform.h"
#include "utils.h"

#include <cstdio>
#include <cstring>
#include <sys/stat.h>

using namespace LAMMPS_NS;

static constexpr int MAXLINE = 1024;

/* ---------------------------------------------------------------------- */

std::string SkinStateSection::title() const
{
  if (std::strcmp(input->command, "read_data") != 0) return "";
  for (int k = 0; k + 3 < input->narg; k++) {
    if (std::strcmp(input->arg[k], "fix") != 0) continue;
    const Fix *const fix = modify->get_fix_by_id(input->arg[k + 1]);
    if (fix && utils::strmatch(fix->style, "^property/atom")) return input->arg[k + 3];
  }
  return "";
}

/* ----------------------------------------------------------------------
   whether a data file has a section
------------------------------------------------------------------------- */

static bool has_section(const std::string &path, const std::string &title)
{
  const bool packed = platform::has_compress_extension(path);
  FILE *const file = packed ? platform::compressed_read(path) : fopen(path.c_str(), "r");
  if (!file) return true;    // LAMMPS has read it
  char line[MAXLINE];
  bool found = false;
  while (!found && fgets(line, MAXLINE, file))
    found = utils::trim(utils::trim_comment(line)) == title;
  if (packed) platform::pclose(file);
  else fclose(file);
  return found;
}

/* ---------------------------------------------------------------------- */

void SkinStateSection::check(tagint id)
{
  const std::string path = input->arg[0], section = title();
  struct stat now = {};
  stat(path.c_str(), &now);
  const std::string looked = fmt::format("{} {} {} {}.{}", path, section, now.st_size,
                                         now.st_mtim.tv_sec, now.st_mtim.tv_nsec);
  if (looked == looked_at) return;
  if (!has_section(path, section))
    error->one(FLERR, "Fix skin/cells: data file {} has no section {}, from which read_data was to "
               "take the state of cell {}", path, section, id);
  looked_at = looked;
}
