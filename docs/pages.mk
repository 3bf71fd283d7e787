# What makes the tables and pictures of docs/: a row for each, with its command and its inputs.
# `make pages` makes all of them. Runs are kept in $(RUNS). What is there for the same content is not
# run again, and a `make pages` that was stopped goes on; to begin from nothing, remove $(RUNS).
# `make -k pages` goes on with other rows after an error.
#
# The ensembles take about 3 hours of one core of an AMD EPYC: 448 runs of the quarter size of 20 s each,
# 8 that are four times as long, 7 of the paper's size of about 90 s each, as `skin check` expects. What the measurements
# of numerics and speed take in all has not been measured.

RUNS := runs/pages
SKIN := OMP_NUM_THREADS=1 $(BIN)/skin
REDUCED = $(BIN)/python docs/pages.py reduce
MADE :=

SCENES := ring cluster random nd-a nd-b nd-c nd-d
QUARTER := $(SCENES:%=quarter-%)
THREE := quarter-ring quarter-nd-b quarter-nd-d
TWO := quarter-ring quarter-nd-b

# ---- tables of ensembles: folder in docs/data, scenes, seeds, options
# `skin ensemble` itself knows which runs are there, so it is always asked.

define ensemble
MADE += $(2:%=docs/data/$(1)%.csv.gz)
$(2:%=docs/data/$(1)%.csv.gz) &: $(INSTALLED) always
	mkdir -p docs/data/$(1)
	rm -f $(2:%=$(RUNS)/data/$(1)%.csv.gz)
	$(SKIN) ensemble $(2) --seeds $(3) $(4) -o $(RUNS)/data/$(1)
	cp $(2:%=$(RUNS)/data/$(1)%.csv.gz) docs/data/$(1)
endef
row = $(eval $(call ensemble,$(1),$(2),$(3),$(4)))

$(call row,,$(QUARTER),1-8,)
$(call row,,paper-ring paper-random,1-2,)
$(call row,,$(patsubst %,paper-%,cluster nd-a nd-b nd-c nd-d),1,)

# the readings of docs/readings.md; that of the default is above
FIFTEEN := --set cells.generations=15
ENDLESS := --set cells.generations=endless
$(call row,readings/papilla-10/,$(THREE),1-8,--parameters papilla)
$(call row,readings/weak5-10/,$(THREE),1-8,--parameters weak5)
$(call row,readings/direct5-10/,$(THREE),1-8,--parameters direct5)
$(call row,readings/earlier-15/,$(QUARTER),1-8,--parameters earlier $(FIFTEEN))
$(call row,readings/earlier-endless/,$(THREE),1-8,--parameters earlier $(ENDLESS))
$(call row,readings/earlier-full-10/,$(THREE),1-8,--parameters earlier-full)
$(call row,readings/earlier-full-15/,$(THREE),1-8,--parameters earlier-full $(FIFTEEN))
$(call row,readings/earlier-stiff-10/,$(QUARTER),1-8,--parameters earlier-stiff)
$(call row,readings/earlier-stiff-15/,$(QUARTER),1-8,--parameters earlier-stiff $(FIFTEEN))
$(call row,readings/earlier-stiff-endless/,$(THREE),1-8,--parameters earlier-stiff $(ENDLESS))
$(call row,readings/bending-2/,$(TWO),1-4,--set membrane.bending_stiffness=2.0)
$(call row,readings/bending-5/,$(TWO),1-4,--set membrane.bending_stiffness=5.0)
$(call row,readings/bending-20/,$(TWO),1-4,--set membrane.bending_stiffness=20.0)
$(call row,readings/long/,$(TWO),1-4,--set end_time=4000.0)

TABLES := $(MADE)

# ---- pages that the tables make

MADE += docs/ensembles.md docs/readings.md docs/figures/readings.png
docs/ensembles.md: $(TABLES)
	$(SKIN) claims docs/data -o $@
docs/readings.md docs/figures/readings.png &: $(TABLES)
	$(SKIN) claims docs/data docs/data/readings/* -o docs/readings.md -o docs/figures/readings.png

# ---- runs that are looked at, or from which measurements begin: directory in $(RUNS), options

define run
$(RUNS)/$(1).done: $(INSTALLED)
	$(SKIN) run $(2) -o $(RUNS)/$(1) --force
	@touch $$@
endef
directory = $(eval $(call run,$(1),$(2)))
STATE := --set output.dump_interval=0.0

$(call directory,quarter-ring,quarter-ring)
$(call directory,wound,wound)
$(call directory,papilla,$(RUNS)/papilla.toml)
$(call directory,paper-ring,paper-ring)
$(call directory,crowded,quarter-ring --set end_time=450.0 $(STATE))
LIMITED := --set numerics.integrator=rkl1 --set numerics.timestep=0.25 --set numerics.stiffness_limit=100
$(call directory,crowded-papilla,quarter-ring --parameters papilla --set end_time=450.0 $(STATE) $(LIMITED))
COMMA := ,
$(call directory,sixteenth,quarter-ring --set 'membrane.lattice=[50$(COMMA)58]' --set cells.stem=4 --set end_time=400.0)

# ---- pictures: docs/figures.md, docs/reproduction.md, docs/interventions.md, docs/start.md,
# docs/tutorial.md

QUICK := figure-3-quick figure-5-quick figure-6-quick
COURSES := $(QUICK:%=docs/figures/%.png)
MADE += docs/figures/figure-1.png $(COURSES)
docs/figures/figure-1.png: $(INSTALLED)
	$(SKIN) figure 1 -o docs/figures
	$(REDUCED) $@
$(COURSES): docs/figures/figure-%-quick.png: $(TABLES)
	$(SKIN) figure $* --quick --data docs/data -o docs/figures

OF_RUNS := docs/figures/figure-2.png docs/figures/figure-2-quick.png docs/figures/figure-4-quick.png
MADE += $(OF_RUNS)
$(OF_RUNS): $(INSTALLED)
	$(SKIN) figure $(word 2,$(subst -, ,$(basename $(@F)))) $(if $(findstring quick,$@),--quick) --data $(RUNS)/shown --yes -o docs/figures
	$(REDUCED) $@

SEEN := cells-t600 stem-t1000 height-t600 section-t1000 clones-t600 lineage-t600 demo
MADE += $(SEEN:%=docs/figures/%.png)
docs/figures/cells-t600.png: VIEW := --time 600
docs/figures/stem-t1000.png: VIEW := --time 1000 --show stem
docs/figures/height-t600.png: VIEW := --time 600 --view height
docs/figures/section-t1000.png: VIEW := --time 1000 --view section
docs/figures/clones-t600.png: VIEW := --time 600 --view clones
docs/figures/lineage-t600.png: VIEW := --time 600 --view lineage
docs/figures/demo.png: VIEW := --time 1000 --view all
$(SEEN:%=docs/figures/%.png): $(RUNS)/quarter-ring.done
	$(SKIN) snapshot $(RUNS)/quarter-ring $(VIEW) -o $@
	$(REDUCED) $@

MADE += docs/figures/report.png
docs/figures/report.png: $(RUNS)/quarter-ring.done
	$(SKIN) report $(RUNS)/quarter-ring -o $(RUNS)/report.html
	$(BIN)/python docs/pages.py screenshot $(RUNS)/report.html $@
	$(REDUCED) $@

MADE += docs/figures/report-study.png
docs/figures/report-study.png: $(INSTALLED)
	$(SKIN) study docs/examples/adhesion.toml --keep -o $(RUNS)/adhesion
	$(SKIN) report $(RUNS)/adhesion -o $(RUNS)/study.html
	$(BIN)/python docs/pages.py screenshot $(RUNS)/study.html $@
	$(REDUCED) $@

MADE += docs/figures/tutorial-demo.png
$(call directory,tutorial-demo,demo --set end_time=400.0)
docs/figures/tutorial-demo.png: $(RUNS)/tutorial-demo.done
	$(SKIN) snapshot $(RUNS)/tutorial-demo --view all -o $@
	$(REDUCED) $@

MADE += docs/figures/wound.png docs/figures/papilla-start.png
docs/figures/wound.png: $(RUNS)/wound.done
	$(BIN)/python docs/pages.py moments $(RUNS)/wound $@ 290 300 350
docs/figures/papilla-start.png: $(RUNS)/papilla.done
	$(SKIN) snapshot $(RUNS)/papilla --time 0 --view section --y 10 -o $@
$(RUNS)/papilla.done: $(RUNS)/papilla.toml
$(RUNS)/papilla.toml: docs/start.md
	mkdir -p $(RUNS)
	$(BIN)/python docs/pages.py papilla $< $(RUNS)

# ---- studies: name, columns that are kept, columns and windows of the picture; docs/studies/

EMPTY :=
LIST = $(subst $(EMPTY) $(EMPTY),$(COMMA),$(1))
define study
MADE += docs/data/studies/$(1)/courses.parquet docs/figures/studies/$(1).png
docs/data/studies/$(1)/courses.parquet: $(INSTALLED)
	$(SKIN) study run $(1) -o $(RUNS)/studies/$(1)
	$(BIN)/python docs/pages.py columns $(RUNS)/studies/$(1)/$$(@F) $$(@D) $(2)
docs/figures/studies/$(1).png: docs/data/studies/$(1)/courses.parquet
	mkdir -p $$(@D)
	$(SKIN) compare $$(<D) --columns '$(call LIST,$(3))' --windows $(call LIST,$(4)) --plot $$@ --against condition
	$(REDUCED) $$@
endef
asked = $(eval $(call study,$(1),$(2),$(3),$(4)))

TIPS := stem_on_tips-stem_tips_expected
STEM := stem_on_tips stem_tips_expected chi_H zeta
TISSUE := ta exhausted coverage none_below membrane_area height_std skewness papillae papilla_height
ND := nd_on_tips nd_tips_expected chi_H_nd zeta_nd
YOUNG := young_on_tips young_tips_expected zeta_young
MUTANT := mutant_on_tips mutant_tips_expected zeta_mutant

$(call asked,outward,$(STEM) $(TISSUE),skewness height_std papillae $(TIPS) zeta none_below,400-600)
$(call asked,photoaging,stem $(STEM) $(TISSUE),height_std papillae papilla_height membrane_area ta skewness,600-750 750-900)
$(call asked,clone,ta exhausted mutantta mutantex $(MUTANT),mutantta mutantex ta,300-400 500-600)
$(call asked,wound,stem ta exhausted coverage,coverage coverage>0.93,700-840)
$(call asked,adhesion,stem nd young $(STEM) $(ND) $(YOUNG) coverage none_below skewness papillae,$(TIPS) nd_on_tips-nd_tips_expected young_on_tips-young_tips_expected zeta zeta_nd zeta_young,400-600)
$(call asked,finite-size,$(STEM) $(TISSUE) papilla_spacing papilla_width cell_area chi_G sigma,papilla_spacing height_std skewness none_below zeta $(TIPS),400-600)

# the example of docs/studies.md
EXAMPLE := stem_on_tips-stem_tips_expected,papillae,zeta
MADE += docs/data/studies/example/courses.parquet docs/figures/studies/example.png
docs/data/studies/example/courses.parquet: $(INSTALLED)
	$(SKIN) study run docs/examples/adhesion.toml -o $(RUNS)/studies/example
	$(BIN)/python docs/pages.py columns $(RUNS)/studies/example/$(@F) $(@D) stem_on_tips stem_tips_expected zeta papillae
docs/figures/studies/example.png: docs/data/studies/example/courses.parquet
	$(SKIN) compare $(<D) --columns $(EXAMPLE) --windows 400-600,600-1000 --plot $@
	$(REDUCED) $@

NINE := chi_H chi_G zeta skewness papillae height_std none_below coverage $(TIPS)
MADE += docs/data/studies/sensitivity/courses.parquet docs/figures/studies/sensitivity.png
docs/data/studies/sensitivity/courses.parquet: $(INSTALLED)
	$(SKIN) study run sensitivity -o $(RUNS)/studies/sensitivity
	$(BIN)/python docs/pages.py columns $(RUNS)/studies/sensitivity/$(@F) $(@D) $(subst -, ,$(NINE))
docs/figures/studies/sensitivity.png: docs/data/studies/sensitivity/courses.parquet
	$(BIN)/python docs/pages.py effects sensitivity $(<D) $@ $(call LIST,$(NINE))
	$(REDUCED) $@

MADE += docs/data/studies/sensitivity-sobol/courses.parquet
docs/data/studies/sensitivity-sobol/courses.parquet: $(INSTALLED)
	$(SKIN) study run sensitivity-sobol -o $(RUNS)/studies/sensitivity-sobol
	$(BIN)/python docs/pages.py columns $(RUNS)/studies/sensitivity-sobol/$(@F) $(@D) chi_H zeta skewness papillae height_std none_below

# the continuum equation beside four runs; its tables are printed, for the page
PRESSED := 1 2 3 4
$(foreach n,$(PRESSED),$(call directory,random-$(n),quarter-random --seed $(n) --until 600 --set output.dump_interval=5.0))
CONTINUUM := docs/data/studies/continuum
OF_WAVES := $(patsubst %,$(CONTINUUM)/%.csv,numbers response solution terms waves)
MADE += $(OF_WAVES) docs/figures/studies/continuum.png
$(OF_WAVES) &: $(PRESSED:%=$(RUNS)/random-%.done)
	OMP_NUM_THREADS=1 $(BIN)/python docs/studies/continuum.py $(PRESSED:%=$(RUNS)/random-%) -o $(@D) --picture docs/figures/studies/continuum.png
docs/figures/studies/continuum.png: $(CONTINUUM)/waves.csv
	$(BIN)/python docs/studies/continuum.py -o $(<D) --picture $@
	$(REDUCED) $@

# ---- measurements of numerics: docs/accuracy.md, docs/stability.md

TRADEOFF := docs/data/tradeoff-quarter-ring
MADE += $(TRADEOFF).csv $(TRADEOFF)-orders.csv $(TRADEOFF)-ensemble.csv $(TRADEOFF).png
$(TRADEOFF).csv $(TRADEOFF)-orders.csv $(TRADEOFF)-ensemble.csv $(TRADEOFF).png &: $(RUNS)/crowded.done
	$(SKIN) tradeoff quarter-ring --interval 10 --from $(RUNS)/crowded --seeds 9-16 --windows 300-600,800-1000 --data $(RUNS)/levels -o $(RUNS)/tradeoff
	for file in $(RUNS)/tradeoff/quarter-ring*.csv $(RUNS)/tradeoff/quarter-ring.png; do cp $$file docs/data/tradeoff-$${file##*/}; done

MADE += docs/data/tradeoff-papilla.csv
docs/data/tradeoff-papilla.csv: $(RUNS)/crowded-papilla.done
	$(SKIN) tradeoff quarter-ring --parameters papilla --quick --interval 2 --from $(RUNS)/crowded-papilla -o $(RUNS)/tradeoff-papilla
	cp $(RUNS)/tradeoff-papilla/quarter-ring.csv $@

MADE += docs/data/stability-quarter-ring.csv docs/data/stability-quarter-ring.png
docs/data/stability-quarter-ring.csv docs/data/stability-quarter-ring.png &: $(RUNS)/crowded.done
	$(SKIN) stability quarter-ring --from $(RUNS)/crowded --vary stiffness,adhesion,bending,division --factors 1,10 --methods euler,rkl1,rkl2 --stages 13 --interval 16 -o $(RUNS)/stability
	for suffix in csv png; do cp $(RUNS)/stability/quarter-ring.$$suffix docs/data/stability-quarter-ring.$$suffix; done

MADE += docs/data/stability-papilla.csv
docs/data/stability-papilla.csv: $(RUNS)/crowded-papilla.done
	$(SKIN) stability quarter-ring --parameters papilla --from $(RUNS)/crowded-papilla --vary stiffness,bending,adhesion,stretch,spring,division --factors 0.1,1,10 -o $(RUNS)/stability-papilla
	cp $(RUNS)/stability-papilla/quarter-ring.csv $@

OTHERS := bare-membrane two-cells one-stem demo no-dermis
MADE += docs/data/stability-others.csv
docs/data/stability-others.csv: $(INSTALLED)
	for scene in $(OTHERS); do $(SKIN) stability $$scene --parameters papilla --interval 20 --vary bending,stretch,adhesion,spring -o $(RUNS)/stability-others; done
	$(BIN)/python docs/pages.py join $@ $(OTHERS:%=$(RUNS)/stability-others/%.csv)

# ---- scaling: docs/scaling.md

SCALING := sizes memory ranks traffic
MADE += $(SCALING:%=docs/data/scaling-%.csv) docs/figures/scaling.png
docs/data/scaling-sizes.csv: HOW := --steps 24 --rounds 5
docs/data/scaling-ranks.csv: HOW := --steps 32 --rounds 5
docs/data/scaling-traffic.csv: HOW := --steps 8 --copies 2
$(SCALING:%=docs/data/scaling-%.csv): docs/data/scaling-%.csv: $(RUNS)/sixteenth.done
	$(BIN)/python benchmarks/scaling.py $* $(RUNS)/sixteenth $(HOW)
MADE += docs/data/scaling-small.csv
docs/data/scaling-small.csv: $(INSTALLED)
	$(BIN)/python benchmarks/scaling.py small --steps 20 --rounds 5
docs/figures/scaling.png: $(SCALING:%=docs/data/scaling-%.csv)
	$(BIN)/python benchmarks/scaling_model.py

# ---- what runs cost, beside what is expected: docs/speed.md

SMALL := bare-membrane demo loose-stem mutant no-dermis one-stem slow-stem stiffening thinning two-cells two-ta wound
COST := $(BIN)/python benchmarks/run_cost.py
MADE += docs/data/run-costs.csv
docs/data/run-costs.csv: $(INSTALLED)
	$(COST) runs $(SMALL) quarter-ring --levels balanced fast --keep $(RUNS)/costs
	$(COST) runs paper-ring $(filter-out quarter-ring,$(QUARTER)) --levels balanced --keep $(RUNS)/costs
	set -e; for scene in $(SMALL) quarter-ring; do $(COST) samples $(RUNS)/costs/$$scene-balanced --levels reference; done
	$(COST) samples $(RUNS)/costs/paper-ring-balanced --levels reference fast

# ---- what benchmarks print, for the tables of pages: docs/speed.md, docs/accuracy.md, docs/stability.md

PRINTED := $(RUNS)/printed
SAID := step_cost rebuild_cost membrane_cost whole_run eigenvalues
$(PRINTED)/step_cost: $(INSTALLED)
$(PRINTED)/rebuild_cost $(PRINTED)/membrane_cost: $(RUNS)/paper-ring.done
$(PRINTED)/rebuild_cost $(PRINTED)/membrane_cost: HOW := --run $(RUNS)/paper-ring
$(PRINTED)/whole_run $(PRINTED)/eigenvalues: $(RUNS)/quarter-ring.done
$(PRINTED)/whole_run: HOW := $(RUNS)/quarter-ring --ages 0 300 450 600 800 1000 --rounds 3
$(PRINTED)/eigenvalues: HOW := $(RUNS)/quarter-ring 300 450 600 800 1000
$(SAID:%=$(PRINTED)/%): $(PRINTED)/%:
	mkdir -p $(@D)
	$(BIN)/python benchmarks/$*.py $(HOW) > $@.part
	mv $@.part $@

.PHONY: pages made always
pages: $(MADE) $(SAID:%=$(PRINTED)/%)
made:
	@printf '%s\n' $(MADE)
always:
