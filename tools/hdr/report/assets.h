#pragma once
// The files of web/, as they are.
namespace hdr::report::assets {

extern const char* const kStyle;
extern const char* const kPlotScript;     ///< the read-out of plots
extern const char* const kPictureScript;  ///< data out of the page, and canvases of class "picture"
extern const char* const kShaderScript;   ///< what kProbeScript draws with
extern const char* const kProbeScript;    ///< canvases of class "viewer"; needs both above

}  // namespace hdr::report::assets
