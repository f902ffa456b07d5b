// SPDX-License-Identifier: Apache-2.0
// The .geo language as far as Couplet lets it through: gmsh's own lists are Parser/Gmsh.l, Parser/Gmsh.y, Mesh/Field.cpp
// and Common/DefaultOptions.h.
#include "common/mesh/gmsh/geo_words.hpp"

#include <set>
#include <sstream>
#include <string>

namespace couplet::mesh::geo_words {
namespace {

class Words {
 public:
  explicit Words(const char* text) {
    std::istringstream in(text);
    for (std::string word; in >> word;) words_.insert(word);
  }
  bool has(std::string_view word) const { return words_.contains(word); }

 private:
  std::set<std::string, std::less<>> words_;
};

}  // namespace

bool is_control(std::string_view word) {
  static const Words words("If ElseIf Else EndIf For EndFor Macro Function Return Call");
  return words.has(word);
}

bool is_allowed(std::string_view word) {
  static const Words words(R"(
    newp newl newc newll newcl news newsl newv newf newreg Pi
    Abs Acos ArcCos ArcSin ArcTan ArcTan2 Asin Atan Atan2 Ceil Cos Cosh Exp Fabs Floor Fmod Hypot Log Log10 Max Min
    Modulo Rand Round Sin Sinh Sqrt Tan Tanh Exists
    List LinSpace LogSpace Unique Catenary Find
    Str StrCat Sprintf StrCmp UpperCase LowerCase
    Point Line Curve Circle Ellipse Ellipsis Spline CatmullRom BSpline Bezier Nurbs Knots Order Wire Compound Plane
    Ruled Surface Volume Sewing Coordinates Euclidian Sphere PolarSphere
    Box Block Cylinder Cone Wedge Torus Disk Rectangle Ellipsoid ThickSolid ThruSections Fillet Chamfer
    BooleanUnion BooleanFuse BooleanIntersection BooleanCommon BooleanDifference BooleanCut BooleanFragments
    BooleanCoherence BooleanSection ShapeFromFile
    Extrude Translate Rotate Symmetry Dilate Affine Split Intersect Layers ScaleLastLayer Hole
    QuadTriAddVerts QuadTriNoNewVerts QuadtriAddverts QuadtriNonewVerts RecombLaterals TransfQuadTri Using In
    Delete Recursive Coherence BoundingBox Mass CenterOfMass MatrixOfInertia Parent Degenerated
    Physical Transfinite Recombine Smoother Periodic Reverse ReverseMesh ReorientMesh MeshSize Characteristic Length
    MeshAlgorithm MeshSizeFromBoundary Field SetFactory SetTag SetMaxTag
    DefineConstant UndefineConstant Printf Warning Error
    GMSH_MAJOR_VERSION GMSH_MINOR_VERSION GMSH_PATCH_VERSION)");
  return words.has(word) || is_control(word);
}

bool takes_a_number(std::string_view word) {
  static const Words words("Progression Bump Beta");
  return words.has(word);
}

bool takes_shapes(std::string_view word) {
  static const Words words(
      "Boundary CombinedBoundary OrientedBoundary PointsOf Duplicata Embedded HealShapes");
  return words.has(word);
}

bool is_noun(std::string_view word) {
  static const Words words(
      "Loop Left Right Alternate AlternateLeft AlternateRight Alternated Background BoundaryLayer Index Model Meshes "
      "Physicals Variables Include Merge Mesh Geometry");
  return words.has(word) || takes_a_number(word) || takes_shapes(word);
}

bool is_refused(std::string_view word) {
  static const Words words(R"(
    Abort AbsolutePath AdaptMesh Alias AliasWithOptions Append Betti ClassifySurfaces CodeName Cohomology Color
    ColorTable Combine CopyOptions Cpu CreateGeometry CreateTopology CurrentDir CurrentDirectory CurrentFileName
    DefineNumber DefineString DimNameSpace DirName Draw Elliptic Exit FileExists FixRelativePath GeoEntity GetEnv
    GetForced GetForcedStr GetNumber GetString GetStringValue GetValue GmshExecutableName Hide Homology
    INTERPOLATION_SCHEME Levelset ListFromFile LowerCaseIn MPI_Rank MPI_Size Memory N2S NameStruct NameToString NewModel
    OnelabAction OnelabRun Parametric Plugin Quadric RecombineMesh RefineMesh RelocateMesh RenumberMeshNodes
    RenumberMeshElements S2N SetChanged SetNumber SetPartition SetString Show Slide StrChoice StrFind StrLen StrPrefix
    StrRelative StrReplace StrSub StringToName Struct SyncModel T2 T3 TIME TestLevel TextAttributes Today TotalMemory
    UnsplitWindow
    System SystemCall NonBlockingSystemCall Print Save CreateDir MergeWithBoundingBox SetName OptimizeMesh SendToServer
    Sleep Remesh SetOrder PartitionMesh SetCurrentWindow SplitCurrentWindowHorizontal SplitCurrentWindowVertical
    General Solver PostProcessing View ExternalProcess PythonCode)");
  return words.has(word);
}

bool is_attribute(std::string_view word) {
  static const Words words(R"(
    Name Label ShortHelp Help Units Min Max Step Choices Visible ReadOnly ReadOnlyRange Highlight Closed AutoCheck
    Range Loop Graph Kind NeverChanged MultipleSelection)");
  return words.has(word);
}

bool gives_text(std::string_view word) {
  static const Words words("Str StrCat Sprintf UpperCase LowerCase");
  return words.has(word);
}

bool takes_texts(std::string_view word) {
  static const Words words("StrCmp SetFactory Printf Warning Error DefineConstant UndefineConstant");
  return words.has(word) || gives_text(word);
}

bool is_option(std::string_view family, std::string_view name) {
  static const Words geometry(R"(
    AutoCoherence CopyMeshingMethod ExactExtrusion ExtrudeReturnLateralEntities ExtrudeSplinePoints
    MatchMeshScaleFactor MatchMeshTolerance NumSubEdges OCCAutoFix OCCAutoEmbed OCCBooleanPreserveNumbering
    OCCBoundsUseStl OCCDisableStl OCCFixDegenerated OCCFixSmallEdges OCCFixSmallFaces OCCImportLabels OCCMakeSolids
    OCCParallel OCCSafeUnbind OCCScaling OCCSewFaces OCCThruSectionsDegree OCCUnionUnify OCCUseGenericClosestPoint
    OldCircle OldRuledSurface OldNewReg OldNewreg OffsetX OffsetY OffsetZ ReparamOnFaceRobust ScalingFactor
    OrientedPhysicals SnapX SnapY SnapZ Tolerance ToleranceBoolean Transform TransformXX TransformXY TransformXZ
    TransformYX TransformYY TransformYZ TransformZX TransformZY TransformZZ Points Curves Lines Surfaces Volumes
    PointNumbers CurveNumbers LineNumbers SurfaceNumbers VolumeNumbers PointLabels CurveLabels SurfaceLabels
    VolumeLabels LabelType PointSize CurveWidth SurfaceType)");
  static const Words mesh(R"(
    Algorithm Algorithm3D AlgorithmSwitchOnFailure AngleSmoothNormals AngleToleranceFacetOverlap AnisoMax
    AllowSwapAngle BoundaryLayerFanElements BoundaryLayerFanPoints CharacteristicLengthExtendFromBoundary
    CharacteristicLengthFactor CharacteristicLengthMin CharacteristicLengthMax CharacteristicLengthFromCurvature
    CharacteristicLengthFromPoints CharacteristicLengthFromParametricPoints CompoundClassify
    CompoundCharacteristicLengthFactor CompoundMeshSizeFactor ElementOrder FlexibleTransfinite HighOrderOptimize
    IgnoreParametrization IgnorePeriodicity LcIntegrationPrecision MaxIterDelaunay3D MaxRetries
    MeshSizeExtendFromBoundary MeshSizeFactor MeshSizeMin MeshSizeMax MeshSizeFromCurvature
    MeshSizeFromCurvatureIsotropic MeshSizeFromPoints MeshSizeFromParametricPoints MinimumCircleNodes
    MinimumCirclePoints MinimumCurveNodes MinimumCurvePoints MinimumElementsPerTwoPi MshFileVersion
    NewtonConvergenceTestXYZ Optimize OptimizeThreshold OptimizeNetgen QualityType QuadqsSizemapMethod
    QuadqsTopologyOptimizationMethods QuadqsRemeshingBoldness RandomFactor RandomFactor3D RandomSeed
    RecombinationAlgorithm RecombineAll RecombineOptimizeTopology RecombineMinimumQuality RecombineNodeRepositioning
    Recombine3DAll Recombine3DLevel Recombine3DConformity RefineSteps Renumber SaveAll SecondOrderIncomplete
    SecondOrderLinear ScalingFactor Smoothing SmoothNormals SmoothRatio StlAngularDeflection StlLinearDeflection
    StlOneSolidPerSurface StlRemoveDuplicateTriangles StlRemoveBadTriangles SubdivisionAlgorithm ToleranceEdgeLength
    ToleranceInitialDelaunay ToleranceReferenceElement TransfiniteTri UnvStrictFormat Points PointNumbers Nodes
    NodeLabels Lines LineNumbers SurfaceEdges SurfaceFaces VolumeEdges VolumeFaces SurfaceNumbers VolumeNumbers
    Triangles Quadrangles Tetrahedra Hexahedra Prisms Pyramids ColorCarousel LabelType)");
  return (family == "Mesh" && mesh.has(name)) || (family == "Geometry" && geometry.has(name));
}

bool is_field(std::string_view kind) {
  static const Words words(R"(
    Attractor AttractorAnisoCurve Ball BoundaryLayer Box Constant Curvature Cylinder Distance Extend Frustum Gradient
    IntersectAniso Laplacian LonLat MathEval MathEvalAniso Max MaxEigenHessian Mean Min MinAniso Octree Param Restrict
    Threshold)");
  return words.has(kind);
}

bool is_formula(std::string_view option) {
  static const Words words("F FX FY FZ M11 M12 M13 M22 M23 M33 m11 m12 m13 m22 m23 m33");
  return words.has(option);
}

}  // namespace couplet::mesh::geo_words
