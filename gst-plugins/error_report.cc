// SPDX-License-Identifier: Apache-2.0
#include "gst-plugins/error_report.h"

#include <exception>

#include "gpu-kernels/backend.h"
#include "gst-plugins/debug.h"
#include "gst-plugins/progressive.h"
#include "service/dds/dds_error.h"
#include "service/options/option.h"

namespace windhover {

void PostCurrentException(GstElement* element, bool while_starting) noexcept {
  try {
    throw;
  } catch (const OptionError& error) {
    if (while_starting) {
      GST_ELEMENT_ERROR(element, LIBRARY, SETTINGS, ("%s", error.what()), (nullptr));
    } else {
      GST_ELEMENT_ERROR(element, STREAM, FORMAT, ("%s", error.what()), (nullptr));
    }
  } catch (const UnsupportedVideo& error) {
    GST_ELEMENT_ERROR(element, STREAM, FORMAT, ("%s", error.what()), (nullptr));
  } catch (const DeviceError& error) {
    if (while_starting) {
      GST_ELEMENT_ERROR(element, RESOURCE, NOT_FOUND, ("%s", error.what()), (nullptr));
    } else {
      GST_ELEMENT_ERROR(element, RESOURCE, FAILED, ("%s", error.what()), (nullptr));
    }
  } catch (const DdsError& error) {
    GST_ELEMENT_ERROR(element, RESOURCE, OPEN_WRITE, ("%s", error.what()), (nullptr));
  } catch (const std::exception& error) {
    GST_ELEMENT_ERROR(element, LIBRARY, FAILED, ("%s", error.what()), (nullptr));
  } catch (...) {
    GST_ELEMENT_ERROR(element, LIBRARY, FAILED, ("unknown failure"), (nullptr));
  }
}

}  // namespace windhover
