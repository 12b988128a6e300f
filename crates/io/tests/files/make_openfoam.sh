#!/bin/bash
# Writes the cases in openfoam/ by the programs of OpenFOAM (v1912; Debian: apt-get install openfoam), each with the .vtu files
# that its foamToVTK makes: a mesh of hexahedra and prisms in two zones as text with three times, the same in bytes, packed,
# decomposed, and decomposed with the files of all processors in one (collated), and its dual of polyhedra. Where the programs miss
# their settings: export WM_PROJECT_DIR=/usr/share/openfoam.
set -e
folder=${1:-openfoam}
rm -rf "$folder"
mkdir -p "$folder/text/system" "$folder/text/constant"
cd "$folder"
head() { echo "FoamFile { version 2.0; format ascii; class $1; object $2; }"; }
settings() {
    { head dictionary controlDict; echo "application none; startFrom startTime; startTime 0; stopAt endTime; endTime 10; deltaT 1;
        writeControl timeStep; writeInterval 1; writeFormat $1; writePrecision 16; timePrecision 6; writeCompression $2;
        timeFormat general; runTimeModifiable false;"; } > system/controlDict
}
cd text
settings ascii off
{ head dictionary fvSchemes; echo "ddtSchemes {} gradSchemes {} divSchemes {} laplacianSchemes {} interpolationSchemes {} snGradSchemes {}"; } > system/fvSchemes
{ head dictionary fvSolution; echo "solvers {}"; } > system/fvSolution
{ head dictionary decomposeParDict; echo "numberOfSubdomains 2; method simple; simpleCoeffs { n (2 1 1); delta 0.001; }"; } > system/decomposeParDict
{ head dictionary blockMeshDict; echo "convertToMeters 1;
vertices ((0 0 0) (1 0 0) (1 1 0) (0 1 0) (0 0 1) (1 0 1.2) (1 1 1) (0 1 1) (2 0 0) (2 0 1));
blocks (hex (0 1 2 3 4 5 6 7) left (2 2 2) simpleGrading (1 1 1) hex (1 8 2 2 5 9 6 6) right (2 2 2) simpleGrading (1 1 1));
edges (); boundary ( walls { type wall; faces ((0 4 7 3) (0 1 5 4) (1 8 9 5)); } );"; } > system/blockMeshDict
blockMesh > /dev/null
fields() {
    for time in 0 2 10; do
        mkdir -p $time
        postProcess -func writeCellCentres -time $time > /dev/null
        rm -f $time/C[yz] $time/Cx.gz
        [ -f $time/C ] || exit 1
        rm -f $time/Cx
    done
    python3 "$here/fields.py" 0 2 10
}
here=$(pwd)
cat > fields.py <<'P'
"""T = x² - y z + time at the centres of cells that C has, D = (x, y, 2 z) at the points, and a uniform tensor."""
import re, sys
numbers = lambda text: [[float(w) for w in t.split()] for t in re.findall(r"\(([-+.e\d]+ [-+.e\d]+ [-+.e\d]+)\)", text)]
head = lambda kind, name: f"FoamFile {{ version 2.0; format ascii; class {kind}; object {name}; }}\n#include \"settings\"\ndimensions [0 0 0 0 0 0 0];\n"
rest = "boundaryField { \"(walls|defaultFaces)\" { type calculated; value $internalField; } }\n"
zero = "boundaryField { \".*\" { type zeroGradient; } }\n"
lines = lambda values: f"{len(values)}\n(\n" + "\n".join(values) + "\n)\n;\n"
for time in sys.argv[1:]:
    text = open(f"{time}/C").read()
    centres = numbers(text[: text.index("boundaryField")])
    values = [repr(x * x - y * z + float(time)) for x, y, z in centres]
    open(f"{time}/T", "w").write(head("volScalarField", "T").replace('#include "settings"\n', "") + "internalField nonuniform List<scalar>\n" + lines(values) + zero)
    points = numbers(open("constant/polyMesh/points").read())
    values = [f"({x!r} {y!r} {2 * z!r})" for x, y, z in points]
    open(f"{time}/D", "w").write(head("pointVectorField", "D").replace('#include "settings"\n', "") + "internalField nonuniform List<vector>\n" + lines(values) + "boundaryField { \".*\" { type calculated; } }\n")
    open(f"{time}/S", "w").write(head("volSymmTensorField", "S").replace('#include "settings"\n', "") + "internalField uniform (1 2 3 4 5 6);\n" + zero)
P
fields
vtu() { foamToVTK -no-boundary -no-point-data -time "$1" > /dev/null; mv VTK/*/internal.vtu "../$2.vtu"; rm -r VTK; }
vtu 10 text
cd ..
cp -r text bytes
cp -r text dual
cp -r text decomposed
cp -r text collated
(cd bytes && rm -r 0 2 && settings binary off && foamFormatConvert -time 10 > /dev/null && foamFormatConvert -constant > /dev/null)
cp -r bytes packed
(cd packed && rm -r 10 && cp -r ../text/10 . && settings ascii on && foamFormatConvert -time 10 > /dev/null && foamFormatConvert -constant > /dev/null; rm -f constant/polyMesh/{points,faces,owner,neighbour,cellZones} )
(cd dual && rm -r 0 2 10 && polyDualMesh -overwrite 60 > /dev/null && mkdir 10 && postProcess -func writeCellCentres -time 10 > /dev/null && rm 10/C?  && python3 fields.py 10 && vtu 10 dual)
(cd decomposed && rm -r 0 2 && decomposePar -time 10 > /dev/null && rm -r 10 constant)
collate() { rm -rf processors2; settings "$1" off; decomposePar -fileHandler collated -time 10 > /dev/null; mkdir -p "../collated_$1/system"; mv processors2 "../collated_$1"; cp system/controlDict "../collated_$1/system"; }
(cd collated && rm -r 0 2 && collate ascii && collate binary)
rm -r collated
LC_ALL=C find collated_* -type f -exec sed -i '1,20s#location .*/collated/#location "#' {} +
rm -f ./*/fields.py ./*/system/{fv*,block*,decomp*} ./*/constant/polyMesh/*{Zones,set}*.orig
find . -name "*Addressing*" -delete
find . \( -name "*.obj" -o -name faceZones -o -name pointZones \) -delete
find . \( -name C -o -name C.gz \) -not -path "./text/10/*" -not -path "./bytes/10/*" -not -path "./packed/10/*" -delete
find . -name uniform -prune -exec rm -r {} +
find . -name sets -prune -exec rm -r {} +
