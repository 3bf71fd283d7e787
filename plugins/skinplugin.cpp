// registration of the styles of lammps-skin, and nothing else

#include "bond_skin_stretch.h"
#include "dihedral_skin_bend.h"
#include "fix_skin_cells.h"
#include "fix_skin_cells_record.h"
#include "fix_skin_motion.h"
#include "pair_skin_adhesion.h"
#include "pair_skin_core.h"
#include "pair_skin_dermis.h"
#include "pair_skin_lj.h"
#include "skin_binary.h"

#include "lammps.h"

using namespace LAMMPS_NS;

// the plugin interface of LAMMPS as its manual documents it:
// the header that declares it is not part of the binary packages

extern "C" {
typedef void *(lammpsplugin_factory1) (LAMMPS *);
typedef void *(lammpsplugin_factory2) (LAMMPS *, int, char **);

struct lammpsplugin_t {
  const char *version;
  const char *style;
  const char *name;
  const char *info;
  const char *author;
  union {
    lammpsplugin_factory1 *v1;
    lammpsplugin_factory2 *v2;
  } creator;
  void *handle;
};

typedef void (*lammpsplugin_regfunc)(lammpsplugin_t *, void *);
}

static void *create_bond_skin_stretch(LAMMPS *lmp)
{
  return new BondSkinStretch(lmp);
}

static void *create_dihedral_skin_bend(LAMMPS *lmp)
{
  return new DihedralSkinBend(lmp);
}

static void *create_pair_skin_adhesion(LAMMPS *lmp)
{
  return new PairSkinAdhesion(lmp);
}

static void *create_pair_skin_core(LAMMPS *lmp)
{
  return new PairSkinCore(lmp);
}

static void *create_pair_skin_dermis(LAMMPS *lmp)
{
  return new PairSkinDermis(lmp);
}

static void *create_pair_skin_lj(LAMMPS *lmp)
{
  return new PairSkinLJ(lmp);
}

static void *create_fix_skin_cells(LAMMPS *lmp, int narg, char **arg)
{
  return new FixSkinCells(lmp, narg, arg);
}

static void *create_fix_skin_cells_record(LAMMPS *lmp, int narg, char **arg)
{
  return new FixSkinCellsRecord(lmp, narg, arg);
}

static void *create_fix_skin_motion(LAMMPS *lmp, int narg, char **arg)
{
  return new FixSkinMotion(lmp, narg, arg);
}

extern "C" __attribute__((visibility("default"))) void lammpsplugin_init(void *lmp, void *handle,
                                                                         void *regfunc)
{
  if (!skin_fits((LAMMPS *) lmp, handle)) return;

  auto register_plugin = (lammpsplugin_regfunc) regfunc;
  lammpsplugin_t plugin = {};

  plugin.version = ((LAMMPS *) lmp)->version;    // the one that it was compiled for
  plugin.author = "the lammps-skin authors";
  plugin.handle = handle;

  plugin.style = "bond";
  plugin.name = "skin/stretch";
  plugin.info = "links of a basement membrane";
  plugin.creator.v1 = &create_bond_skin_stretch;
  register_plugin(&plugin, lmp);

  plugin.style = "dihedral";
  plugin.name = "skin/bend";
  plugin.info = "bending of a triangulated membrane by the normals of its triangles";
  plugin.creator.v1 = &create_dihedral_skin_bend;
  register_plugin(&plugin, lmp);

  plugin.style = "pair";
  plugin.name = "skin/adhesion";
  plugin.info = "weak adhesion of cells";
  plugin.creator.v1 = &create_pair_skin_adhesion;
  register_plugin(&plugin, lmp);

  plugin.style = "pair";
  plugin.name = "skin/core";
  plugin.info = "ends a run where particles overlap too much";
  plugin.creator.v1 = &create_pair_skin_core;
  register_plugin(&plugin, lmp);

  plugin.style = "pair";
  plugin.name = "skin/dermis";
  plugin.info = "soft spheres of a dermis";
  plugin.creator.v1 = &create_pair_skin_dermis;
  register_plugin(&plugin, lmp);

  plugin.style = "pair";
  plugin.name = "skin/lj";
  plugin.info = "exclusion and attraction of Lennard-Jones shape";
  plugin.creator.v1 = &create_pair_skin_lj;
  register_plugin(&plugin, lmp);

  plugin.style = "fix";
  plugin.name = "skin/cells";
  plugin.info = "adhesion, division and removal of epidermal cells on a basement membrane";
  plugin.creator.v2 = &create_fix_skin_cells;
  register_plugin(&plugin, lmp);

  plugin.style = "fix";
  plugin.name = FixSkinCellsRecord::STYLE;
  plugin.info = "what a fix skin/cells leaves to the next one";
  plugin.creator.v2 = &create_fix_skin_cells_record;
  register_plugin(&plugin, lmp);

  plugin.style = "fix";
  plugin.name = "skin/motion";
  plugin.info = "overdamped motion that divides steps in which a particle would move too far";
  plugin.creator.v2 = &create_fix_skin_motion;
  register_plugin(&plugin, lmp);
}
